#include "pdx/options/adapt_options.hpp"

#include "pdx/base/options.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::options {
namespace {
/// In horizons, and in elements: the larger counts.
struct Usual {
  double horizons, elements;
};
constexpr Usual kCritical[] = {{2.0, 0.0}, {3.0, 1.0}}; // static, in time
constexpr Usual kExpansion[] = {{4.0, 0.0}, {7.0, 2.0}};
constexpr Usual kContraction[] = {{4.0, 0.0}, {8.0, 2.4}};

double length(double given, const Usual& usual, double horizon, double element)
{
  return given > 0.0 ? given : std::max(usual.horizons * horizon, usual.elements * element);
}

/// Options of patches that move, where none do.
void refuse_lengths(const SceneOptions& s)
{
  for (const char* name : {"-adapt_critical_length", "-adapt_every"})
    if (Options("layout").given(name))
      throw UserError(fmt::format("{} steers patches that move: give -adapt expand or relocate, or drop it", name));
  if (!s.pd.seeded && Options("layout").given("-adapt_expansion_length"))
    throw UserError("-adapt_expansion_length steers patches that move, and those of -adapt_seed tip: give -adapt "
                    "expand, relocate or that, or drop it");
}

/// What bulk bears is looked at in time, and makes particles of one lattice in each body.
void judge_triggers(const SceneOptions& s)
{
  const Triggers& t = s.layout.triggers;
  if (!t.any()) return;
  if (s.layout.adapt != Adapt::expand)
    throw UserError(s.layout.adapt == Adapt::none
                        ? "-adapt_trigger says when bulk becomes particles: give -adapt expand, or drop it"
                        : "-adapt relocate hands back what breaks: -adapt_trigger connection, stress and stretch need "
                          "-adapt expand");
  if (s.time.analysis != Analysis::explicit_dynamics)
    throw UserError("-adapt_trigger connection, stress and stretch act in time: give -analysis explicit, or damage");
  if (s.pd.spacing.size() > 1)
    throw UserError(fmt::format("-pd_spacing has {} values: must be one for the particles that -adapt_trigger makes",
                                s.pd.spacing.size()));
}
} // namespace

double critical_length(const SceneOptions& options, double horizon, double element)
{
  return length(options.layout.critical_length, kCritical[options.time.dynamic()], horizon, element);
}

double expansion_length(const SceneOptions& options, double horizon, double element)
{
  return length(options.layout.expansion_length, kExpansion[options.time.dynamic()], horizon, element);
}

double contraction_length(const SceneOptions& options, double horizon, double element)
{
  return length(options.layout.contraction_length, kContraction[options.time.dynamic()], horizon, element);
}

namespace {
void judge_face_mass(const SceneOptions& s)
{
  if (s.face_mass && s.scheme != couple::Scheme::energy)
    throw UserError(fmt::format(
        "-couple_face_mass is of bonds up to the border, which {0} has not: take the energy coupling, or drop it",
        couple::option_of(s.scheme)));
  if (s.face_mass && (!s.time.dynamic() || !s.pd.bordered()))
    throw UserError(
        "-couple_face_mass is of particles beside elements or points that move, with bonds up to the border: "
        "drop it, or give -pd_patches and -analysis explicit");
}
} // namespace

void judge_adapt(const SceneOptions& s)
{
  judge_face_mass(s);
  judge_triggers(s);
  if (s.layout.adapt == Adapt::none) refuse_lengths(s);
  if (s.layout.adapt != Adapt::relocate)
    for (const char* name : {"-adapt_contraction_length", "-adapt_expansions", "-adapt_tracker"})
      if (Options("layout").given(name))
        throw UserError(fmt::format("{} steers what patches hand back: give -adapt relocate, or drop it", name));
  if (Options("layout").given("-adapt_border") && (s.layout.patches_move() || !s.pd.bordered() || !s.fracture.active()))
    throw UserError("-adapt_border is of patches between elements that stay while bonds break: drop it");
  if (!s.layout.patches_move()) return;
  if (s.pd.patches.empty() && s.pd.boxes.empty() && !s.pd.seeded && !s.converts())
    throw UserError("-adapt (-layout_renew_box) moves patches between elements: give boxes by -pd_patches, or "
                    "-adapt_seed tip, or drop it");
  if (s.time.analysis == Analysis::implicit_dynamics)
    throw UserError("-adapt (-layout_renew_box): implicit steps keep their layout; give -analysis explicit or static");
  if (s.scheme != couple::Scheme::energy && s.scheme != couple::Scheme::handshake)
    throw UserError("-adapt (-layout_renew_box) makes patches of any shape, which need -couple_scheme energy");
  if (s.layout.adapt == Adapt::none) return;
  if (!s.fracture.active())
    throw UserError("-adapt follows what breaks: give -material_toughness or -pd_critical_stretch");
}

void judge_seeds(const SceneOptions& options)
{
  const PdOptions& pd = options.pd;
  if (!pd.cloud.empty())
    throw UserError("-adapt_seed tip puts patches between elements, and a -pd_cloud has none: drop one of them");
  if (pd.everywhere || !pd.patches.empty())
    throw UserError("-adapt_seed tip says where patches lie, and so do -pd_patches: give one of them");
  if (options.cracks.lines.empty())
    throw UserError("-adapt_seed tip puts patches at the tips of cracks, but there is none: give -crack_names, or "
                    "-pd_patches");
  if (pd.spacing.size() > 1)
    throw UserError(
        fmt::format("-pd_spacing has {} values: must be one for the patches of -adapt_seed tip", pd.spacing.size()));
}
} // namespace pdx::options
