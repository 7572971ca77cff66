#pragma once
#include "pdx/change/patch_mover.hpp"
#include "pdx/record/checkpoint_file.hpp"
#include "pdx/record/run_files.hpp"
#include "pdx/scene/dormant.hpp"
#include "pdx/scene/layout.hpp"

namespace pdx::change {
/// What a run needs of the checkpoint that it goes on from before its scene can be built.
struct CheckpointHead {
  std::unique_ptr<io::SealedReader> file; ///< the rest of it is read once the scene stands
  record::NamedNumbers numbers;
  scene::Layout layout;
  scene::Dormant dormant;
};

/// What is wrong with the numbers of a checkpoint, "" if nothing is.
using FaultOfNumbers = std::string (*)(const record::NamedNumbers& numbers);

/// Reads the head of `-restart`, says to the files how far they were, and lets the mover go on. Throws UserError for a
/// file that is none, or of another scene. Collective.
/// @param given the scene as the options say it
CheckpointHead read_head(record::RunFiles& files, PatchMover& mover, const std::string& given, FaultOfNumbers fault);
} // namespace pdx::change
