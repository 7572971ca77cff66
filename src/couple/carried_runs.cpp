#include "pdx/couple/carried_runs.hpp"

#include <cmath>
#include <tuple>

namespace pdx::couple {
namespace carried_runs {
constexpr Index kMargin = 24, kPlaces = kRunTile + 2 * kMargin; // of a side; bonds lead into the margins
/// Places that a bond leads along a side, at most: a block of 8 that moves on by them stays in the margins.
constexpr Index kFarthest = 16;
constexpr double kSame = 1e-11;   // two weights, apart by rounding
constexpr std::size_t kLeast = 2; // bonds of a run
constexpr double kWorth = 1.5;    // bonds for each block of whatever their tile needs

/// Are all weights of a those of b? What b has none of weighs nothing.
template <int Dim> bool weighs_as(const CarriedPoints<Dim>& points, Index a, Index b)
{
  const auto rows = points.rows(b);
  for (std::size_t k = 0; k < points.rows(a).size(); ++k) {
    const auto there = std::ranges::find(rows, points.rows(a)[k]);
    const double other = there == rows.end() ? 0.0 : points.weights(b)[static_cast<std::size_t>(there - rows.begin())];
    if (!(std::abs(points.weights(a)[k] - other) <= kSame)) return false;
  }
  return true;
}

template <int Dim> bool same(const CarriedPoints<Dim>& points, Index a, Index b)
{
  return a == b || (weighs_as(points, a, b) && weighs_as(points, b, a));
}
} // namespace carried_runs

/// What is next to each other along a side: rows of particles, or carried points; -1: none.
template <int Dim> struct CarriedRuns<Dim>::Line {
  std::int64_t key; // depth of particles; where in their cells the points are
  std::array<Index, carried_runs::kPlaces> who;

  explicit Line(std::int64_t its_key) : key(its_key) { who.fill(-1); }
};

/// A run and its bonds, those from one particle together.
template <int Dim> struct CarriedRuns<Dim>::Piece {
  struct Lane {
    Index place, point; // of the particle in its line
    std::vector<const RunBond<Dim>*> bonds;
  };
  std::vector<Lane> lanes;      // ascending
  std::size_t from = 0, to = 0; // lines of particles and points
  Index cell = 0;               // places that the points are further

  Index first() const { return lanes.front().place / kRunBlock * kRunBlock; }
  Index blocks() const { return lanes.back().place / kRunBlock - lanes.front().place / kRunBlock + 1; }
};

/// A tile before it is laid out.
template <int Dim> class CarriedRuns<Dim>::Tile {
public:
  Tile(const CarriedPoints<Dim>& points, std::span<const PlacedBond<Dim>> bonds) : points_(points)
  {
    for (auto first = bonds.begin(), end = first; first != bonds.end(); first = end) {
      end = std::find_if(first, bonds.end(), [&](const PlacedBond<Dim>& b) { return b.kind != first->kind; });
      take({first, end});
    }
    order();
  }

  std::vector<Line> from, to;
  std::vector<Piece> pieces;

  bool worth_it() const
  {
    std::size_t bonds = 0, blocks = 0;
    for (const Piece& piece : pieces) {
      blocks += static_cast<std::size_t>(piece.blocks());
      for (const auto& lane : piece.lanes) bonds += lane.bonds.size();
    }
    for (const auto* lines : {&from, &to})
      for (const Line& line : *lines)
        for (std::size_t k = 0; k < line.who.size(); k += kRunBlock)
          blocks += std::any_of(line.who.begin() + k, line.who.begin() + k + kRunBlock, [](Index w) { return w >= 0; });
    return static_cast<double>(bonds) >= carried_runs::kWorth * static_cast<double>(blocks);
  }

  /// Rows that carry the points, ascending.
  std::vector<Index> hosts() const
  {
    std::vector<Index> all;
    for (const Line& line : to)
      for (const Index point : line.who)
        if (point >= 0) all.insert(all.end(), points_.rows(point).begin(), points_.rows(point).end());
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

private:
  /// Bonds of one kind, in order of places: those from one particle to other points are a run for themselves.
  void take(std::span<const PlacedBond<Dim>> bonds)
  {
    std::vector<Piece> apart;
    for (const PlacedBond<Dim>& placed : bonds) {
      const RunBond<Dim>& bond = *placed.bond;
      const Index place = placed.place % kRunTile + carried_runs::kMargin;
      const auto fits = [&](const Piece& piece) {
        const auto& last = piece.lanes.back();
        if (last.place == place) return carried_runs::same(points_, last.point, bond.point);
        return place / kRunBlock <= last.place / kRunBlock + 1; // no block without bonds
      };
      auto piece = std::ranges::find_if(apart, fits);
      if (piece == apart.end()) piece = apart.insert(piece, Piece{});
      if (piece->lanes.empty() || piece->lanes.back().place < place) piece->lanes.push_back({place, bond.point, {}});
      piece->lanes.back().bonds.push_back(&bond);
    }
    const Index cell = bonds.front().cell;
    const std::int64_t within = bonds.front().within;
    const Index depth = bonds.front().bond->leaves.depth;
    for (Piece& piece : apart) {
      if (piece.lanes.size() < carried_runs::kLeast || std::abs(cell) > carried_runs::kFarthest) continue;
      piece.cell = cell;
      piece.from = line(from, depth, [](const Line&) { return true; });
      piece.to = line(to, within, [&](const Line& points) {
        return std::ranges::all_of(piece.lanes, [&](const auto& lane) {
          const Index there = points.who[static_cast<std::size_t>(lane.place + cell)];
          return there < 0 || carried_runs::same(points_, there, lane.point);
        });
      });
      for (const auto& lane : piece.lanes) {
        from[piece.from].who[static_cast<std::size_t>(lane.place)] = lane.bonds.front()->row;
        Index& there = to[piece.to].who[static_cast<std::size_t>(lane.place + cell)];
        if (there < 0) there = lane.point;
      }
      pieces.push_back(std::move(piece));
    }
  }

  template <class Fits> static std::size_t line(std::vector<Line>& lines, std::int64_t key, Fits fits)
  {
    const auto found = std::ranges::find_if(lines, [&](const Line& l) { return l.key == key && fits(l); });
    if (found != lines.end()) return static_cast<std::size_t>(found - lines.begin());
    lines.emplace_back(key);
    return lines.size() - 1;
  }

  /// In turns among the lines of points: what has just been stored would be loaded from one place further, for which
  /// the processor waits.
  void order()
  {
    std::vector<std::size_t> seen(to.size(), 0);
    std::vector<std::tuple<std::size_t, std::size_t, std::size_t>> turns; // turn, line, number
    for (std::size_t k = 0; k < pieces.size(); ++k) turns.emplace_back(seen[pieces[k].to]++, pieces[k].to, k);
    std::ranges::sort(turns);
    std::vector<Piece> ordered;
    for (const auto& turn : turns) ordered.push_back(std::move(pieces[std::get<2>(turn)]));
    pieces = std::move(ordered);
  }

  const CarriedPoints<Dim>& points_;
};

template <int Dim>
CarriedRuns<Dim>::CarriedRuns(const CarriedPoints<Dim>& points, std::span<const RunBond<Dim>> bonds, Index owned)
    : owned_(owned)
{
  const std::vector<PlacedBond<Dim>> sorted = in_order<Dim>(bonds);
  for (auto first = sorted.begin(), end = first; first != sorted.end(); first = end) {
    end = std::find_if(first, sorted.end(), [&](const PlacedBond<Dim>& b) { return b.tile() != first->tile(); });
    const Tile draft(points, {first, end});
    if (draft.worth_it()) add(draft, points);
  }
  known_weights_.clear();
  far_.assign(tiles_.size(), 0);
}

template <int Dim> void CarriedRuns<Dim>::add(const Tile& tile, const CarriedPoints<Dim>& points)
{
  constexpr Index line = kRunParts<Dim> * carried_runs::kPlaces;
  const std::vector<Index> hosts = tile.hosts();
  Index at = 0;
  for (const Line& particles : tile.from) add_particles(particles, line * at++);
  for (const Line& carried : tile.to) add_points(carried, line * at++, points, hosts);
  const auto all = static_cast<Index>(tile.from.size());
  for (const Piece& piece : tile.pieces)
    add_run(piece, line * static_cast<Index>(piece.from), line * (all + static_cast<Index>(piece.to)));
  rows_.insert(rows_.end(), hosts.begin(), hosts.end());
  tiles_.push_back({particles_.size(), points_.size(), runs_.size(), rows_.size()});
  scratch_.resize(std::max(scratch_.size(), static_cast<std::size_t>(line * at)), 0.0);
  sums_.resize(std::max(sums_.size(), hosts.size() * Dim * kRunBlock), 0.0);
}

template <int Dim> void CarriedRuns<Dim>::add_particles(const Line& line, Index scratch)
{
  for (std::size_t k = 0; k < line.who.size(); k += kRunBlock) {
    const std::span<const Index> who(line.who.data() + k, kRunBlock);
    if (std::ranges::all_of(who, [](Index row) { return row < 0; })) continue;
    bool next = who.back() < owned_;
    for (std::size_t l = 0; l < who.size(); ++l)
      next = next && who[l] >= 0 && who[l] == who.front() + static_cast<Index>(l);
    particles_.push_back(
        {scratch + static_cast<Index>(k), next ? who.front() : -1, static_cast<std::ptrdiff_t>(particle_rows_.size())});
    if (!next) particle_rows_.insert(particle_rows_.end(), who.begin(), who.end());
  }
}

template <int Dim>
void CarriedRuns<Dim>::add_points(const Line& line, Index scratch, const CarriedPoints<Dim>& points,
                                  std::span<const Index> rows)
{
  for (std::size_t k = 0; k < line.who.size(); k += kRunBlock) {
    std::vector<Index> hosts;
    std::vector<double> weights;
    for (std::size_t l = 0; l < kRunBlock; ++l) {
      const Index point = line.who[k + l];
      if (point < 0) continue;
      for (std::size_t h = 0; h < points.rows(point).size(); ++h) {
        const auto host = static_cast<Index>(std::ranges::lower_bound(rows, points.rows(point)[h]) - rows.begin());
        const auto known = std::ranges::find(hosts, host);
        const auto at = static_cast<std::size_t>(known - hosts.begin());
        if (known == hosts.end()) {
          hosts.push_back(host);
          weights.resize(weights.size() + kRunBlock, 0.0);
        }
        weights[at * kRunBlock + l] += points.weights(point)[h];
      }
    }
    if (hosts.empty()) continue;
    points_.push_back({scratch + static_cast<Index>(k), static_cast<Index>(hosts.size()),
                       static_cast<std::ptrdiff_t>(hosts_.size()), place_weights(std::move(weights))});
    hosts_.insert(hosts_.end(), hosts.begin(), hosts.end());
  }
}

/// Weights repeat along a side: the fewer there are, the nearer is the cache that they stay in.
template <int Dim> std::ptrdiff_t CarriedRuns<Dim>::place_weights(std::vector<double> weights)
{
  std::vector<std::int64_t> rounded;
  for (const double weight : weights) rounded.push_back(std::llround(weight / carried_runs::kSame));
  const auto [known, fresh] = known_weights_.try_emplace(rounded, static_cast<std::ptrdiff_t>(weights_.size()));
  if (fresh) weights_.insert(weights_.end(), weights.begin(), weights.end());
  return known->second;
}

template <int Dim> void CarriedRuns<Dim>::add_run(const Piece& piece, Index from, Index to)
{
  const RunBond<Dim>& bond = *piece.lanes.front().bonds.front();
  Run<Dim> run;
  run.from = from + piece.first();
  run.to = to + piece.first() + piece.cell;
  run.blocks = piece.blocks();
  for (std::size_t d = 0; d < Dim; ++d) run.xi[d] = bond.xi[static_cast<Eigen::Index>(d)];
  run.per_square = 1.0 / bond.xi.squaredNorm();
  run.limit = std::numeric_limits<double>::infinity();
  run.stiffness = static_cast<std::ptrdiff_t>(stiffness_.size());
  for (const auto& lane : piece.lanes)
    for (const RunBond<Dim>* one : lane.bonds) {
      numbers_.push_back(one->number);
      lanes_.push_back(run.stiffness + lane.place - piece.first());
    }
  stiffness_.resize(stiffness_.size() + static_cast<std::size_t>(run.blocks) * kRunBlock, 0.0);
  runs_.push_back(run);
  patches_.push_back(bond.no_fail ? -1 : bond.patch);
  stretches_.push_back(bond.stretch);
}

template <int Dim> RunView<Dim> CarriedRuns<Dim>::view() const
{
  RunView<Dim> view;
  view.tiles = tiles_;
  view.particles = particles_;
  view.points = points_;
  view.runs = runs_;
  view.rows = rows_;
  view.particle_rows = particle_rows_.data();
  view.hosts = hosts_.data();
  view.weights = weights_.data();
  view.stiffness = stiffness_.data();
  view.pitch = carried_runs::kPlaces;
  view.scratch = scratch_.data();
  view.sums = sums_.data();
  view.far = far_.data();
  return view;
}

template <int Dim>
bool CarriedRuns<Dim>::add_forces(Processor processor, bool finite, std::span<const double> u,
                                  std::span<double> r) const
{
  return add_run_forces<Dim>(processor, view(), finite, u.data(), owned_, r.data());
}

template <int Dim> double CarriedRuns<Dim>::energy(Processor processor, bool finite, std::span<const double> u) const
{
  return run_energy<Dim>(processor, view(), finite, u.data(), owned_);
}

template class CarriedRuns<2>;
template class CarriedRuns<3>;
} // namespace pdx::couple
