#include "pdx/options/scene_signature.hpp"

#include "pdx/base/fingerprint.hpp"
#include "pdx/base/given_options.hpp"
#include "pdx/base/options.hpp"
#include "pdx/base/quantity.hpp"
#include "pdx/io/disk_file.hpp"

#include <algorithm>
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pdx::options {
namespace {
constexpr std::size_t kBlock = std::size_t{1} << 24; // [B]

/// Beginnings of names that may change, and why.
constexpr std::string_view kMayChange[] = {"-output_",
                                           "-quiet",
                                           "-dry_run",
                                           "-warnings_are_errors",
                                           "-probe_",
                                           "-case",
                                           "-checkpoint_",
                                           "-restart", // what is written
                                           "-layout_renew_interval",
                                           "-adapt_border",
                                           "-rebalance_",
                                           "-mpm_skip_rest", // what is the same with and without
                                           "-ts_",
                                           "-analysis",
                                           "-load_",       // when it ends; the length of steps is compared apart
                                           "-bc_",         // loads; what is held is compared as a state
                                           "-pd_operator", // how it is solved
                                           "-static_condense",
                                           "-crack_",
                                           "-pd_cloud",
                                           "-mesh_file", // compared by what they say
                                           "-post_"};
constexpr std::string_view kMayNotChange[] = {
    "-post_tip_damage", "-ts_subcycle"}; // of these: tips so far were found by it; accelerations are by it
constexpr std::string_view kPathOfLoads[] = {"-analysis", "-load_steps", "-bc_"}; // likewise, in statics

bool belongs(const std::string& name, bool in_time)
{
  const auto begins = [&](std::string_view beginning) { return name.starts_with(beginning); };
  if (!in_time && std::ranges::any_of(kPathOfLoads, begins)) return true;
  return std::ranges::any_of(kMayNotChange, begins) || std::ranges::none_of(kMayChange, begins);
}

/// The number that a word is where its unit fits; none for all else, file names among them.
std::optional<double> number_in(std::string_view word, const char* unit)
{
  const auto quantity = quantity_in(word);
  const auto has = quantity ? unit_in(quantity->unit) : std::nullopt, wanted = unit_in(unit);
  if (!has || (!quantity->unit.empty() && !(wanted && has->same_kind(*wanted)))) return std::nullopt;
  return value_in(word, unit);
}

/// "1e9, 2" and "1000000000,2.0" alike, and "1mm" and "1e-3" where a length belongs.
std::string plain(std::string_view text, const char* unit)
{
  std::string all;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    std::string_view word = text.substr(from, comma - from);
    while (!word.empty() && (word.front() == ' ' || word.front() == '+')) word.remove_prefix(1);
    while (!word.empty() && word.back() == ' ') word.remove_suffix(1);
    const std::optional<double> value = number_in(word, unit);
    if (!all.empty()) all += ',';
    all += value ? fmt::format("{}", *value) : std::string(word);
    from = comma + 1;
  }
  return all;
}

std::string value_of(Options& options, const OptionDoc& doc)
{
  if (!options.given(doc.name)) return plain(doc.default_value, doc.unit.c_str());
  if (doc.allowed == "true, false") return options.boolean(doc.name, false, "") ? "true" : "false";
  return plain(options.text(doc.name, "", ""), doc.unit.c_str());
}

/// Of all bytes of a file, 0 for one that cannot be read.
std::uint64_t hash_of_file(const std::string& path)
{
  io::DiskFile file;
  if (path.empty() || file.open(path, O_RDONLY) || !file.is_regular()) return 0;
  std::vector<std::byte> block;
  std::uint64_t hash = 0;
  for (std::uint64_t at = 0, size = file.size(); at < size; at += block.size()) {
    block.resize(std::min<std::uint64_t>(kBlock, size - at));
    if (file.read(block, at)) return 0;
    hash = hash_of(block, hash);
  }
  return hash;
}

/// The hash of the file that an option names, alike on every rank; 0 where none is named.
std::uint64_t hash_of_named(MPI_Comm comm, const Options& options, const std::string& name)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::uint64_t hash = rank || !options.given(name) ? 0 : hash_of_file(given_option(name)->value);
  MPI_Bcast(&hash, 1, MPI_UINT64_T, 0, comm);
  return hash;
}

/// A file of points, of what they fill, or of temperatures, which may lie anywhere as long as it is the same.
bool names_file(const std::string& name)
{
  return name == "-thermal_file" || (name.starts_with("-mpm_") && (name.ends_with("_file") || name.ends_with("_mesh")));
}

std::string lines_of(const SceneOptions& options)
{
  const law::Elastic& m = options.elastic;
  std::string text =
      fmt::format("material = E {} nu {} rho {} thickness {} {}\nkinematics = {}\ncoupling = {}\n", m.young, m.poisson,
                  m.density, m.thickness, m.plane == law::Plane::stress ? "plane stress" : "plane strain",
                  static_cast<int>(options.kinematics), couple::option_of(options.scheme));
  if (options.face_mass) text += "mass = handed to the border\n";
  text += fmt::format("bonds = micromodulus {}, calibration {}, surface correction {}\n",
                      static_cast<int>(options.pd.micromodulus), static_cast<int>(options.pd.calibration),
                      static_cast<int>(options.pd.surface_correction));
  text += fmt::format("corner of the body = {}\n", fmt::join(options.frame.origin(), ", "));
  for (const RegionOptions& r : options.region_set.regions)
    text +=
        fmt::format("region {} = E {} nu {} rho {} thickness {} Gc {} no-fail {}\n", r.name, r.elastic.young,
                    r.elastic.poisson, r.elastic.density, r.elastic.thickness, r.toughness.value_or(0.0), r.no_fail);
  for (const geom::Box<2>& box : options.fracture.no_fail)
    text += fmt::format("no-fail zone = {} {} {} {}\n", box.lower[0], box.lower[1], box.upper[0], box.upper[1]);
  for (std::size_t c = 0; c < options.cracks.lines.size(); ++c) {
    text += fmt::format("crack {} =", c + 1);
    for (const Vector<2>& x : options.cracks.lines[c]) text += fmt::format(" ({}, {})", x[0], x[1]);
    text += "\n";
  }
  return text;
}
} // namespace

std::string given_scene(MPI_Comm comm, const SceneOptions& scene)
{
  Options options("signature");
  std::string text = lines_of(scene);
  const auto& known = documented_options();
  const std::vector<OptionDoc> docs(known.begin(), known.end()); // a copy: reading adds to them
  const auto hashed = [&](const std::string& name) {
    return fmt::format("{} = {:016x}\n", name, hash_of_named(comm, options, name));
  };
  for (const OptionDoc& doc : docs)
    if (names_file(doc.name))
      text += hashed(doc.name);
    else if (belongs(doc.name, scene.time.dynamic()))
      text += fmt::format("{} = {}\n", doc.name, value_of(options, doc));
  if (options.given("-mesh_file")) text += hashed("-mesh_file");
  return text;
}
} // namespace pdx::options
