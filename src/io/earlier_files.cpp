#include "pdx/io/earlier_files.hpp"

#include <algorithm>
#include <fstream>
#include <string_view>

namespace pdx::io {
namespace {
struct Output {
  std::string_view name;
  std::vector<std::string_view> beginnings; ///< none: the name is enough
  bool at_the_end;                          ///< written then, as a whole
};

const std::vector<Output>& outputs()
{
  static const std::vector<Output> all{{"summary.json", {"{\n  \"case\": "}, true},
                                       {"crack_path.csv", {"tip [-],"}, true},
                                       {"summary.json.part", {}, true},
                                       {"checkpoint.h5.part", {}, true},
                                       {"options.opts.part", {}, true},
                                       {"citations.bib.part", {}, true},
                                       {"history.csv.part", {}, true},
                                       {"fields.xdmf.part", {}, true},
                                       {"options.opts", {"# pdxsolve options as used"}, false},
                                       {"citations.bib", {"% pdxsolve: "}, false},
                                       {"history.csv", {"step [-],"}, false},
                                       {"fields.h5", {"\x89HDF\r\n\x1a\n"}, false},
                                       {"fields_before.h5", {"\x89HDF\r\n\x1a\n"}, false},
                                       {"fields.xdmf", {"<?xml version=\"1.0\" ?>\n<Xdmf"}, false},
                                       {"checkpoint.h5", {"\x89HDF\r\n\x1a\n", "pdxsolve sealed file"}, false}};
  return all;
}

/// A plain file that begins as one of ours, or is empty: cut off at its birth.
bool is_ours(const std::filesystem::path& path, const Output& output)
{
  std::error_code none;
  if (std::filesystem::symlink_status(path, none).type() != std::filesystem::file_type::regular) return false;
  if (output.beginnings.empty() || std::filesystem::file_size(path, none) == 0) return true;
  std::string start(32, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  for (const std::string_view beginning : output.beginnings)
    if (start.starts_with(beginning)) return true;
  return false;
}

bool is_probe(const std::filesystem::path& path)
{
  const std::string name = path.filename().string();
  return name.starts_with("probe_") && name.ends_with(".csv") && is_ours(path, {"", {"step [-],"}, false});
}
bool is_vtkhdf(const std::filesystem::path& path)
{
  const std::string name = path.filename().string();
  return name.starts_with("fields_") && (name.ends_with(".vtkhdf") || name.ends_with(".vtkhdf.part")) &&
         is_ours(path, {"", {"\x89HDF\r\n\x1a\n"}, true});
}
} // namespace

std::vector<std::string> clear_earlier_files(const std::filesystem::path& directory, bool goes_on)
{
  std::vector<std::string> gone;
  for (const Output& output : outputs()) {
    const std::filesystem::path path = directory / output.name;
    if ((goes_on && !output.at_the_end) || !is_ours(path, output)) continue;
    std::error_code error;
    if (output.name == "checkpoint.h5")
      std::filesystem::rename(path, directory / "checkpoint_before.h5", error);
    else
      std::filesystem::remove(path, error);
    if (!error) gone.emplace_back(output.name);
  }
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(directory, none))
    if (((!goes_on && is_probe(entry.path())) || is_vtkhdf(entry.path())) &&
        std::filesystem::remove(entry.path(), none))
      gone.insert(gone.begin(), entry.path().filename());
  return gone;
}

bool is_of_a_run(const std::filesystem::path& path)
{
  return std::ranges::any_of(
      outputs(), [&](const Output& output) { return path.filename() == output.name && is_ours(path, output); });
}

bool is_output_of(const std::filesystem::path& file, const std::filesystem::path& directory)
{
  std::error_code none;
  return std::ranges::any_of(outputs(), [&](const Output& output) {
    return std::filesystem::equivalent(file, directory / output.name, none);
  });
}
} // namespace pdx::io
