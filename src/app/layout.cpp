#include "pdx/app/layout.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::app {
namespace {
constexpr const char* kPatches = "/layout_patches"; // spacing, lower and upper corner of each box [m]
constexpr const char* kCracks = "/layout_cracks";   // number of the crack and a point of it [m]

std::vector<double> table(const io::SealedReader& file, const char* name, int columns)
{
  std::vector<double> values(static_cast<std::size_t>(columns) * static_cast<std::size_t>(file.shape(name)[0]));
  file.read(name, 0, columns, std::span<double>(values));
  return values;
}

std::string fault_of_box(const double* row)
{
  if (!(row[0] > 0.0)) return fmt::format("has a spacing of {:g} m", row[0]);
  return row[1] < row[3] && row[2] < row[4] ? "" : "has a box without inside";
}
bool same_patches(const Layout& a, const Layout& b)
{
  const auto same = [](const geom::Box<2>& p, const geom::Box<2>& q) {
    return p.lower == q.lower && p.upper == q.upper;
  };
  return a.spacing == b.spacing && std::ranges::equal(a.patches, b.patches, same);
}
} // namespace

Layout Layout::given(const SceneOptions& options)
{
  Layout layout{options.pd.patches, {}, options.cracks.lines};
  for (std::size_t p = 0; p < layout.patches.size(); ++p) layout.spacing.push_back(options.pd.spacing_of(p));
  return layout;
}

SceneOptions Layout::in(SceneOptions options) const
{
  if (!patches.empty()) {
    options.pd.patches = patches;
    options.pd.spacing = spacing;
  }
  options.cracks.lines = cracks;
  return options;
}

void Layout::write(io::Hdf5File& file) const
{
  int rank = 0;
  MPI_Comm_rank(file.comm(), &rank);
  std::vector<double> boxes, points;
  for (std::size_t p = 0; p < patches.size() && rank == 0; ++p)
    boxes.insert(boxes.end(),
                 {spacing[p], patches[p].lower[0], patches[p].lower[1], patches[p].upper[0], patches[p].upper[1]});
  for (std::size_t k = 0; k < cracks.size() && rank == 0; ++k)
    for (const Vector<2>& x : cracks[k]) points.insert(points.end(), {static_cast<double>(k), x[0], x[1]});
  file.dataset(kPatches, std::span<const double>(boxes), 5);
  file.dataset(kCracks, std::span<const double>(points), 3);
}

Layout Layout::read(const io::SealedReader& file, const Layout& given)
{
  Layout layout;
  const std::vector<double> boxes = table(file, kPatches, 5), points = table(file, kCracks, 3);
  for (std::size_t k = 0; k < boxes.size(); k += 5) {
    const double* row = boxes.data() + k;
    file.require(kPatches, fault_of_box(row));
    layout.spacing.push_back(row[0]);
    layout.patches.push_back({{row[1], row[2]}, {row[3], row[4]}});
  }
  for (std::size_t k = 0; k < points.size(); k += 3) {
    const auto cracks = static_cast<double>(layout.cracks.size());
    file.require(kCracks, points[k] == cracks || (cracks > 0.0 && points[k] == cracks - 1.0)
                              ? ""
                              : fmt::format("has crack {} behind {}", points[k], cracks));
    layout.cracks.resize(static_cast<std::size_t>(points[k]) + 1);
    layout.cracks.back().push_back({points[k + 1], points[k + 2]});
  }
  file.require(kPatches, same_patches(layout, given) ? "" : "is not where the patches of this scene lie");
  file.require(kCracks, layout.cracks == given.cracks ? "" : "is not where the cracks of this scene run");
  return layout;
}
} // namespace pdx::app
