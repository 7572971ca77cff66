#include "pdx/scene/support.hpp"

#include <fmt/format.h>

namespace pdx::scene {
namespace {
std::string described(const couple::LoosePart& part, const geom::Frame& frame)
{
  if (part.whole) return fmt::format("the body can {}", part.motion);
  return fmt::format("a part of the body, from {} to {} m with {} nodes and {} particles, is "
                     "joined to nothing else and can {}{}",
                     frame.text(part.box.lower), frame.text(part.box.upper), part.nodes, part.particles, part.motion,
                     part.others ? fmt::format(" ({} more are loose)", part.others) : "");
}
} // namespace

void require_support(const couple::LooseParts& parts, const geom::Frame& frame)
{
  const auto loose = parts.find(0);
  if (!loose) return;
  throw UserError(fmt::format("{}: the -bc_..._displacement conditions must hold all rigid motions{}",
                              described(*loose, frame), loose->whole ? "" : " of each part"));
}

void require_support_after_breaking(const couple::LooseParts& parts, Index debris, const geom::Frame& frame)
{
  if (const auto loose = parts.find(debris))
    throw UserError(
        fmt::format("bonds have broken until {}: there is no static answer beyond the loads accepted so far; "
                    "hold it by -bc_..._displacement conditions or use -analysis explicit",
                    described(*loose, frame)));
}
} // namespace pdx::scene
