#include "pdx/fem/element_sweep.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

namespace pdx::fem {
namespace {
/// A run of one element.
struct Candidate {
  RectangleRun run;
  Index element;
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

bool holds(std::span<const Index> numbers, Index number) { return std::ranges::binary_search(numbers, number); }

QuadBlocks blocks_of(std::span<const ElementSweep::Element> elements, Processor processor)
{
  std::vector<Corners> corners;
  std::vector<std::array<Index, 4>> rows;
  for (const ElementSweep::Element& element : elements) {
    corners.push_back(element.corners);
    rows.push_back(element.rows);
  }
  return quad_blocks(processor, corners, rows);
}
} // namespace

/// Elements that are to be sorted, and which runs gave theirs up.
struct ElementSweep::Pool {
  std::vector<Index> elements;
  std::vector<std::uint8_t> opened; // per run

  void take(const std::vector<Index>& members, std::size_t run)
  {
    elements.insert(elements.end(), members.begin(), members.end());
    opened[run] = 1;
  }
};

ElementSweep::ElementSweep(const law::Elastic& law, Kinematics kinematics, std::span<const Element> elements,
                           Index owned, Processor processor)
    : law_(law), kinematics_(kinematics), processor_(processor), owned_(owned)
{
  std::vector<Index> all(elements.size());
  std::iota(all.begin(), all.end(), Index{0});
  *this = ElementSweep(
      law, kinematics, all, [&](Index k) { return elements[static_cast<std::size_t>(k)]; }, owned, processor);
}

ElementSweep::ElementSweep(const law::Elastic& law, Kinematics kinematics, std::span<const Index> numbers,
                           const Source& element, Index owned, Processor processor)
    : law_(law), kinematics_(kinematics), processor_(processor), owned_(owned)
{
  for (const bool counted : {true, false}) {
    Part part{counted, {}, {}, {}, {}};
    Pool pool;
    for (const Index number : numbers)
      if (element(number).counted == counted) pool.elements.push_back(number);
    lay(part, std::move(pool), element);
    parts_.push_back(std::move(part));
  }
}

void ElementSweep::change(const Change& change, const Source& element)
{
  owned_ = change.owned;
  for (Part& part : parts_) {
    Pool pool = open(part, change);
    for (const Index number : change.entering)
      if (element(number).counted == part.counted) pool.elements.push_back(number);
    std::ranges::sort(pool.elements);
    const bool was_crowded = part.crowded;
    lay(part, std::move(pool), element);
    if (part.crowded && !was_crowded) {
      Pool all{part.rest, std::vector<std::uint8_t>(part.runs.size(), 0)};
      for (std::size_t k = 0; k < part.runs.size(); ++k) all.take(part.members[k], k);
      std::ranges::sort(all.elements);
      lay(part, std::move(all), element);
    }
  }
}

/// All that changes or is in no run; what stays in a run is numbered.
ElementSweep::Pool ElementSweep::open(Part& part, const Change& change) const
{
  Pool pool{{}, std::vector<std::uint8_t>(part.runs.size(), 0)};
  const auto now = [&](Index row) { return change.rows.empty() ? row : change.rows[static_cast<std::size_t>(row)]; };
  for (std::size_t k = 0; k < part.runs.size(); ++k) {
    RectangleRun& run = part.runs[k];
    const auto [least, most] = std::ranges::minmax(part.members[k]);
    const auto next = std::ranges::lower_bound(change.leaving, least);
    bool stays = !part.crowded && (next == change.leaving.end() || *next > most);
    for (Index& first : run.first) {
      const Index to = now(first);
      stays = stays && to >= 0 && now(first + run.elements) == to + run.elements;
      first = to;
    }
    if (!stays) pool.take(part.members[k], k);
  }
  pool.elements.insert(pool.elements.end(), part.rest.begin(), part.rest.end());
  std::erase_if(pool.elements, [&](Index number) { return holds(change.leaving, number); });
  return pool;
}

/// Runs of all that is open, together with those that it goes on in.
void ElementSweep::lay(Part& part, Pool pool, const Source& element) const
{
  const Index shortest = std::max(2, lanes_of(processor_) / 2); // fewer are faster in lanes, together with others
  std::vector<Candidate> candidates;
  part.rest.clear();
  const auto look = [&](Index number) {
    if (auto found = candidate_of(element(number), owned_)) {
      found->element = number;
      candidates.push_back(*found);
    } else
      part.rest.push_back(number);
  };
  const auto open_run = [&](std::size_t run) {
    if (pool.opened[run]) return;
    pool.opened[run] = 1;
    for (const Index number : part.members[run]) look(number);
  };
  candidates.reserve(pool.elements.size());
  for (const Index number : pool.elements) look(number);
  const auto first = [](const RectangleRun& run) { return run.first[0]; };
  if (std::ranges::find(pool.opened, std::uint8_t{0}) != pool.opened.end()) // some are laid already
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const Index row = candidates[k].run.first[0];
      const auto after =
          static_cast<std::size_t>(std::ranges::upper_bound(part.runs, row, {}, first) - part.runs.begin());
      if (after < part.runs.size() && part.runs[after].first[0] == row + 1) open_run(after);
      if (after > 0 && part.runs[after - 1].first[0] + part.runs[after - 1].elements >= row) open_run(after - 1);
    }
  const auto order = [](const Candidate& c) { return std::tuple(c.run.first, c.element); };
  if (!std::ranges::is_sorted(candidates, {}, order)) std::ranges::sort(candidates, {}, order);
  part.crowded = part.crowded || std::ranges::adjacent_find(candidates, {}, [](const Candidate& c) {
                                   return c.run.first[0];
                                 }) != candidates.end();
  std::vector<std::pair<RectangleRun, std::vector<Index>>> laid;
  for (std::size_t k = 0; k < part.runs.size(); ++k)
    if (!pool.opened[k]) laid.emplace_back(part.runs[k], std::move(part.members[k]));
  for (std::size_t begin = 0, end = 0; begin < candidates.size(); begin = end) {
    RectangleRun run = candidates[begin].run;
    for (end = begin + 1; end < candidates.size() && follows(run, candidates[end]); ++end) ++run.elements;
    std::vector<Index> members;
    for (std::size_t k = begin; k < end; ++k) members.push_back(candidates[k].element);
    if (run.elements >= shortest)
      laid.emplace_back(run, std::move(members));
    else
      part.rest.insert(part.rest.end(), members.begin(), members.end());
  }
  std::ranges::sort(laid, {}, [](const auto& run) { return std::tuple(run.first.first, run.second.front()); });
  part.runs.clear();
  part.members.clear();
  for (auto& [run, members] : laid) {
    part.runs.push_back(run);
    part.members.push_back(std::move(members));
  }
  std::ranges::sort(part.rest);
  fill_blocks(part, element);
}

void ElementSweep::fill_blocks(Part& part, const Source& element) const
{
  std::vector<Element> inside, border;
  for (const Index number : part.rest) {
    const Element of = element(number);
    const bool is_inside = std::ranges::all_of(of.rows, [&](Index row) { return row < owned_; });
    (is_inside ? inside : border).push_back(of);
  }
  part.blocks.clear();
  for (const bool is_inside : {true, false}) {
    const std::vector<Element>& chosen = is_inside ? inside : border;
    if (chosen.empty()) continue;
    part.blocks.push_back(blocks_of(chosen, processor_));
    part.blocks.back().inside = is_inside;
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
