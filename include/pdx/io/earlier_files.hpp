#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pdx::io {
/// Makes room in a directory, so that nothing new stands beside results of an earlier run there: takes away what is
/// recognised as one's output by its beginning, but keeps a checkpoint as checkpoint_before.h5. Where the run goes on
/// there, only what is written at the end and what a killed run left unfinished goes. Names of what is gone.
std::vector<std::string> clear_earlier_files(const std::filesystem::path& directory, bool goes_on);

/// Did a run write this file, by its name and beginning, or is it empty?
bool is_of_a_run(const std::filesystem::path& path);

/// Is this file one that a run with this directory writes?
bool is_output_of(const std::filesystem::path& file, const std::filesystem::path& directory);
} // namespace pdx::io
