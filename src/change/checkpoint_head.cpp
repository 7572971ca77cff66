#include "pdx/change/checkpoint_head.hpp"

namespace pdx::change {
CheckpointHead read_head(record::RunFiles& files, PatchMover& mover, const std::string& given, FaultOfNumbers fault)
{
  const std::string& path = files.options.time.checkpoint.restart;
  CheckpointHead head;
  head.file = std::make_unique<io::SealedReader>(files.comm(), path);
  // before a scene is built by what the file says
  record::refuse_another(*head.file, path, record::kGivenOptions, given);
  head.numbers = record::read_numbers(*head.file);
  head.file->require("/numbers", fault(head.numbers));
  // The directory it lies in is the run's own: its files go on. Elsewhere new ones begin.
  const bool here = record::is_of(files.comm(), path, files.options.output.directory);
  head.layout = scene::Layout::read(*head.file, files.options);
  if (files.options.layout.patches_move()) head.dormant = scene::Dormant::read(files.comm(), *head.file);
  if (mover.follows()) mover.read(*head.file);
  files.continued = {here, static_cast<int>(head.numbers.at("step")), static_cast<int>(head.numbers.at("fields"))};
  return head;
}
} // namespace pdx::change
