#pragma once
#include "pdx/base/given_options.hpp"
#include "pdx/options/option_words.hpp"

#include <filesystem>
#include <span>

namespace pdx::options {
/// Reads options where users write them, before PETSc sees any: what it does not like it ends with a trace, and what it
/// does not understand it passes over. Every fault is a UserError that names file, line and word.
class OptionReader {
public:
  /// PETSc's own: .petscrc in the home directory, .petscrc and petscrc here. Those that are no files are passed over.
  void read_resource_files(const std::filesystem::path& home);
  void read_environment(const std::string& variable, std::string_view text);
  void read_command_line(std::span<const std::string> words);
  /// All that was read, in order. Refuses a -prefix_push without its -prefix_pop.
  std::vector<GivenOption> take();

  bool help = false, version = false; ///< asked for
  bool json = false;                  ///< help as JSON
  std::string help_words;             ///< behind -help

private:
  using Words = std::span<const OptionWord>;
  void read_file(const std::string& path, const std::string& place);
  void read_line(std::string_view line, const std::string& place);
  void read_words(Words words, const std::string& place);
  void take_option(const std::string& name, Words values, const std::string& place);
  /// The file that an options file names: seen from here or, if there is none, from where that options file lies or
  /// from above it, so that scenes of several files run wherever they are called from.
  std::string found(const std::string& name, const std::string& value) const;
  bool take_flag(const std::string& name, Words values, const std::string& place);
  void take_prefix(const std::string& name, const std::string& value, const std::string& place);

  std::vector<GivenOption> options_;
  std::vector<GivenOption> prefixes_;              // open -prefix_push
  std::vector<std::filesystem::path> directories_; // of the files that are being read
  int depth_ = 0, files_ = 0;
  std::size_t bytes_ = 0; // of files so far
};
} // namespace pdx::options
