#include "pdx/fem/element_sweep.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <tuple>

namespace pdx::fem {
namespace {
/// A run of one element.
struct Candidate {
  RectangleRun run;
  std::size_t element;
  double tolerance; ///< of its sides, from rounding of places [m]
};

bool near(const Vector<2>& a, const Vector<2>& b, double tolerance)
{
  return (a - b).lpNorm<Eigen::Infinity>() <= tolerance;
}

/// The element as the beginning of a run, if it is a rectangle along the axes on two pairs of rows one after the other.
std::optional<Candidate> candidate_of(const ElementSweep::Element& element, Index owned)
{
  const Corners& x = element.corners;
  double reach = 0.0;
  for (const Vector<2>& corner : x) reach = std::max(reach, corner.lpNorm<Eigen::Infinity>());
  const double tolerance = 4.0 * std::numeric_limits<double>::epsilon() * (reach + (x[2] - x[0]).norm());
  for (std::size_t e = 0; e < 4; ++e) {
    const std::size_t ahead = (e + 1) % 4, beyond = (e + 2) % 4, above = (e + 3) % 4;
    const std::array<Index, 4>& rows = element.rows;
    if (rows[ahead] != rows[e] + 1 || rows[beyond] != rows[above] + 1) continue;
    if (rows[ahead] == owned || rows[beyond] == owned) return std::nullopt; // one end owned, the other not
    const Vector<2> along = x[ahead] - x[e], across = x[above] - x[e];
    const bool turned = std::abs(along.y()) > std::abs(along.x());
    const Vector<2> off(along[turned ? 0 : 1], across[turned ? 1 : 0]);
    if (!near(off, Vector<2>::Zero(), tolerance) || !near(x[beyond] - x[above], along, tolerance)) return std::nullopt;
    Candidate found{{}, 0, tolerance};
    found.run = {{rows[e], rows[above]}, 1, along[turned ? 1 : 0], across[turned ? 0 : 1], turned};
    return found;
  }
  return std::nullopt;
}

/// True if b goes on where a ends.
bool follows(const RectangleRun& a, const Candidate& b)
{
  return a.turned == b.run.turned && b.run.first[0] == a.first[0] + a.elements &&
         b.run.first[1] == a.first[1] + a.elements && std::abs(a.along - b.run.along) <= b.tolerance &&
         std::abs(a.across - b.run.across) <= b.tolerance;
}

/// Takes the runs of at least `shortest` elements; the others' numbers stay in `rest`, in order.
std::vector<RectangleRun> take_runs(std::span<const ElementSweep::Element> elements, Index owned, Index shortest,
                                    std::vector<std::size_t>& rest)
{
  std::vector<Candidate> candidates;
  std::vector<std::size_t> others;
  candidates.reserve(rest.size());
  for (const std::size_t k : rest)
    if (auto found = candidate_of(elements[k], owned)) {
      found->element = k;
      candidates.push_back(*found);
    } else
      others.push_back(k);
  const auto order = [](const Candidate& c) { return std::tuple(c.run.first, c.element); };
  if (!std::ranges::is_sorted(candidates, {}, order)) std::ranges::sort(candidates, {}, order);
  std::vector<RectangleRun> runs;
  for (std::size_t begin = 0, end = 0; begin < candidates.size(); begin = end) {
    RectangleRun run = candidates[begin].run;
    for (end = begin + 1; end < candidates.size() && follows(run, candidates[end]); ++end) ++run.elements;
    if (run.elements >= shortest)
      runs.push_back(run);
    else
      for (std::size_t k = begin; k < end; ++k) others.push_back(candidates[k].element);
  }
  std::ranges::sort(others);
  rest = std::move(others);
  return runs;
}

QuadBlocks blocks_of(std::span<const ElementSweep::Element> elements, std::span<const std::size_t> chosen,
                     Processor processor)
{
  std::vector<Corners> corners;
  std::vector<std::array<Index, 4>> rows;
  for (const std::size_t k : chosen) {
    corners.push_back(elements[k].corners);
    rows.push_back(elements[k].rows);
  }
  return quad_blocks(processor, corners, rows);
}
} // namespace

ElementSweep::ElementSweep(const law::Elastic& law, Kinematics kinematics, std::span<const Element> elements,
                           Index owned, Processor processor)
    : law_(law), kinematics_(kinematics), processor_(processor)
{
  const Index shortest = std::max(2, lanes_of(processor) / 2); // fewer are faster in lanes, together with others
  for (const bool counted : {true, false}) {
    Part part{counted, {}, {}};
    std::vector<std::size_t> rest;
    rest.reserve(elements.size());
    for (std::size_t k = 0; k < elements.size(); ++k)
      if (elements[k].counted == counted) rest.push_back(k);
    part.runs = take_runs(elements, owned, shortest, rest);
    const auto inside = [&](std::size_t k) {
      return std::ranges::all_of(elements[k].rows, [&](Index row) { return row < owned; });
    };
    const auto border = std::stable_partition(rest.begin(), rest.end(), inside);
    for (const bool is_inside : {true, false}) {
      const auto chosen = is_inside ? std::span(rest.begin(), border) : std::span(border, rest.end());
      if (chosen.empty()) continue;
      part.blocks.push_back(blocks_of(elements, chosen, processor));
      part.blocks.back().inside = is_inside;
    }
    parts_.push_back(std::move(part));
  }
}

void ElementSweep::add_force(std::span<const double> u, std::span<double> r) const
{
  if (r.empty()) return;
  const SweepFields fields{u.data(), std::ssize(u) / 2, r.data(), std::ssize(r) / 2};
  for (const Part& part : parts_) {
    add_sweep_forces(processor_, part.runs, law_, kinematics_, fields);
    for (const QuadBlocks& blocks : part.blocks) add_sweep_forces(processor_, blocks, law_, kinematics_, fields);
  }
}

double ElementSweep::energy(std::span<const double> u) const
{
  double sum = 0.0;
  const SweepFields fields{u.data(), std::ssize(u) / 2, nullptr, 0};
  for (const Part& part : parts_) {
    if (!part.counted) continue;
    sum += sweep_energy(processor_, part.runs, law_, kinematics_, fields);
    for (const QuadBlocks& blocks : part.blocks) sum += sweep_energy(processor_, blocks, law_, kinematics_, fields);
  }
  return sum;
}

Index ElementSweep::in_runs() const
{
  Index sum = 0;
  for (const Part& part : parts_)
    for (const RectangleRun& run : part.runs) sum += run.elements;
  return sum;
}
} // namespace pdx::fem
