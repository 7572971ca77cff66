#include "pdx/options/probe_options.hpp"

#include "pdx/base/options.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::options {
namespace {
constexpr int kMostPlaces = 100000;

Vector<3> place_of(std::span<const double> v) { return {v[0], v[1], v.size() > 2 ? v[2] : 0.0}; }

ProbeOptions read_probe(const std::string& name, bool solid, int usual, bool describe)
{
  Options o("probe");
  const std::string stem = "-probe_" + name;
  const std::size_t dim = solid ? 3 : 2;
  ProbeOptions probe;
  probe.name = name;
  const auto at =
      o.reals(stem + "_at", {}, o.given(stem + "_at") ? dim : 0, "m", "place of the probe: x,y (solid: x,y,z)");
  const auto line = o.texts(stem + "_line", {},
                            "or places along a line, both ends among them: x0,y0,x1,y1,n (solid: "
                            "x0,y0,z0,x1,y1,z1,n) [m]");
  probe.fields = o.texts(stem + "_field", {"displacement"},
                         "fields by the names they have in fields.h5, or velocity: displacement,stress");
  probe.every = o.integer(stem + "_every", usual, "steps (loads) between rows; the last is always written", {1.0, 1e9});
  if (describe) return probe;
  if (at.empty() == line.empty())
    throw UserError(fmt::format("{0}: a probe has one place or one line: give {0}_at or {0}_line", stem));
  if (!at.empty()) {
    probe.places = {place_of(at)};
    return probe;
  }
  std::vector<double> v;
  for (const std::string& item : line) {
    const auto value = number_of(stem + "_line", item, line.size() == v.size() + 1 ? "-" : "m");
    if (!value || !std::isfinite(*value))
      throw UserError(fmt::format("{}_line is \"{}\": must be a number", stem, item));
    v.push_back(*value);
  }
  if (v.size() != 2 * dim + 1)
    throw UserError(
        fmt::format("{}_line has {} values: must have {}, two ends and how many places", stem, v.size(), 2 * dim + 1));
  if (v.back() != std::floor(v.back()) || v.back() < 2 || v.back() > kMostPlaces)
    throw UserError(
        fmt::format("{}_line has {} places: must be a whole number from 2 to {}", stem, v.back(), kMostPlaces));
  const Vector<3> a = place_of(std::span(v).first(dim)), b = place_of(std::span(v).subspan(dim, dim));
  const int places = static_cast<int>(v.back());
  for (int k = 0; k < places; ++k) probe.places.emplace_back(a + (b - a) * (static_cast<double>(k) / (places - 1)));
  probe.line = true;
  return probe;
}
} // namespace

std::vector<ProbeOptions> ProbeOptions::read(bool solid, int usual, bool describe)
{
  std::vector<std::string> names =
      Options("probe").texts("-probe_names", {}, "names of the probes that follow: each writes probe_NAME.csv");
  if (describe) names = {"NAME"};
  std::vector<ProbeOptions> probes;
  for (const std::string& name : names) {
    if (std::ranges::count(names, name) > 1)
      throw UserError(fmt::format("-probe_names lists {} twice: names must differ", name));
    if (name.find('/') != std::string::npos)
      throw UserError(fmt::format("-probe_names has {}: a name is part of a file's, and has no /", name));
    probes.push_back(read_probe(name, solid, usual, describe));
  }
  return probes;
}
} // namespace pdx::options
