#include "pdx/base/gather.hpp"
#include "pdx/record/probes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pdx::record {
namespace {
constexpr double kInside = 1e-7; // of an element, beyond its sides
constexpr int kNewton = 30;
constexpr int kCorners = 8;

/// A host as ranks tell each other.
struct Offer {
  double distance = std::numeric_limits<double>::infinity(); ///< [m]; 0 in an element
  std::int64_t order = 0;                                    ///< who is first among equals
  std::int64_t points[kCorners] = {};
  double weights[kCorners] = {};
  int count = 0, cells = 0, block = 0;
};

/// Weights of the corners, counted around, if x lies in the element.
std::optional<std::array<double, 4>> in_element(const std::array<Vector<2>, 4>& c, const Vector<2>& x)
{
  double s = 0.5, t = 0.5;
  for (int k = 0; k < kNewton; ++k) {
    const Vector<2> at = (1 - s) * (1 - t) * c[0] + s * (1 - t) * c[1] + s * t * c[2] + (1 - s) * t * c[3];
    const Vector<2> ds = (1 - t) * (c[1] - c[0]) + t * (c[2] - c[3]), dt = (1 - s) * (c[3] - c[0]) + s * (c[2] - c[1]);
    const double det = ds[0] * dt[1] - ds[1] * dt[0];
    if (det == 0.0) return std::nullopt;
    const Vector<2> miss = x - at;
    s += (miss[0] * dt[1] - miss[1] * dt[0]) / det;
    t += (ds[0] * miss[1] - ds[1] * miss[0]) / det;
    if (!(std::abs(s) < 10.0 && std::abs(t) < 10.0)) return std::nullopt;
  }
  if (s < -kInside || s > 1 + kInside || t < -kInside || t > 1 + kInside) return std::nullopt;
  s = std::clamp(s, 0.0, 1.0);
  t = std::clamp(t, 0.0, 1.0);
  return std::array{(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
}

/// Points before those of this rank in the file.
std::int64_t first_point(MPI_Comm comm, const field::OutputBlock& block)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::int64_t mine = static_cast<std::int64_t>(block.natural_point.size()), before = 0;
  MPI_Exscan(&mine, &before, 1, MPI_INT64_T, MPI_SUM, comm);
  return rank ? before : 0;
}

/// The first of the offers that all ranks have, by distance and order.
std::optional<Offer> best(MPI_Comm comm, const Offer& mine)
{
  std::vector<Offer> all = gather_all(comm, std::vector<Offer>{mine});
  const Offer& first = *std::ranges::min_element(all, [](const Offer& a, const Offer& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.order < b.order;
  });
  return std::isfinite(first.distance) ? std::optional(first) : std::nullopt;
}

const field::OutputField* field_of(const field::OutputBlock& block, std::string_view name)
{
  for (const field::OutputField& field : block.fields)
    if (std::string_view(field.name).substr(0, field.name.find(" [")) == name) return &field;
  return nullptr;
}

/// All points of all ranks' elements that this rank's cells lean on: corners may belong to others.
std::vector<double> corners_of_all(MPI_Comm comm, const field::OutputBlock& block)
{
  return gather_all(comm, block.points);
}

Offer offered_by_elements(MPI_Comm comm, const field::OutputBlock& block, int number, const Vector<3>& place)
{
  constexpr double kPlain = 0.0; // of "use"
  const std::vector<double> points = corners_of_all(comm, block);
  const field::OutputField* use = field_of(block, "use");
  const Vector<2> x = place.head<2>();
  Offer offer;
  for (std::size_t cell = 0; 4 * cell < block.cells.size(); ++cell) {
    if (use && use->values[cell] != kPlain) continue;
    std::array<Vector<2>, 4> c;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto p = static_cast<std::size_t>(block.cells[4 * cell + k]);
      c[k] = {points[3 * p], points[3 * p + 1]};
    }
    const Vector<2> low = c[0].cwiseMin(c[1]).cwiseMin(c[2]).cwiseMin(c[3]),
                    high = c[0].cwiseMax(c[1]).cwiseMax(c[2]).cwiseMax(c[3]);
    const double near = kInside * (high - low).maxCoeff();
    if ((x.array() < low.array() - near).any() || (x.array() > high.array() + near).any()) continue;
    const auto weights = in_element(c, x);
    if (!weights) continue;
    offer = {0.0, 0, {}, {}, 4, 1, number};
    for (std::size_t k = 0; k < 4; ++k) {
      offer.points[k] = block.cells[4 * cell + k];
      offer.weights[k] = (*weights)[k];
    }
    offer.order = *std::min_element(block.cells.begin() + static_cast<std::ptrdiff_t>(4 * cell),
                                    block.cells.begin() + static_cast<std::ptrdiff_t>(4 * cell + 4));
    return offer;
  }
  return offer;
}

struct Near {
  std::int64_t number;
  double weight, distance;
};

/// The nearest particle, or the corners of the square (cube) of particles around the place.
Offer offered_by_particles(MPI_Comm comm, const field::OutputBlock& block, int number, const Vector<3>& x,
                           double spacing)
{
  std::vector<Near> mine;
  Near nearest{0, 0.0, std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < block.natural_point.size(); ++k) {
    const Vector<3> away = Vector<3>(block.points[3 * k], block.points[3 * k + 1], block.points[3 * k + 2]) - x;
    const double distance = away.norm();
    const std::int64_t name = block.natural_point[k];
    if (distance < nearest.distance || (distance == nearest.distance && name < nearest.number))
      nearest = {name, 1.0, distance};
    if (spacing <= 0.0) continue;
    double weight = 1.0;
    for (int d = 0; d < 3; ++d) weight *= std::max(0.0, 1.0 - std::abs(away[d]) / spacing);
    if (weight > 1e-12) mine.push_back({name, weight, distance});
  }
  std::vector<Near> around = gather_all(comm, mine);
  std::ranges::sort(around, {}, &Near::number);
  double sum = 0.0;
  for (const Near& near : around) sum += near.weight;
  Offer offer{nearest.distance, nearest.number, {nearest.number}, {1.0}, 1, 0, number};
  if (!(std::abs(sum - 1.0) < 1e-6) || around.size() > kCorners) return offer;
  offer.count = static_cast<int>(around.size());
  for (std::size_t k = 0; k < around.size(); ++k) {
    offer.points[k] = around[k].number;
    offer.weights[k] = around[k].weight / sum;
  }
  return offer;
}
} // namespace

std::optional<ProbeHost> probe_host(MPI_Comm comm, std::span<const field::OutputBlock> blocks, const Vector<3>& place,
                                    double spacing)
{
  std::optional<Offer> found;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const field::OutputBlock& block = blocks[b];
    const int number = static_cast<int>(b);
    const Offer mine = block.quadrilaterals ? offered_by_elements(comm, block, number, place)
                                            : offered_by_particles(comm, block, number, place, spacing);
    const std::optional<Offer> offer = best(comm, mine);
    if (offer && (!found || offer->distance < found->distance)) found = offer;
  }
  if (!found) return std::nullopt;
  const auto count = static_cast<std::size_t>(found->count);
  return ProbeHost{blocks[static_cast<std::size_t>(found->block)].name,
                   found->cells != 0,
                   {found->points, found->points + count},
                   {found->weights, found->weights + count},
                   found->distance};
}

std::vector<double> probe_value(MPI_Comm comm, std::span<const field::OutputBlock> blocks, const ProbeHost& host,
                                const std::string& field)
{
  const auto block = std::ranges::find(blocks, host.block, &field::OutputBlock::name);
  if (block == blocks.end()) return {};
  const field::OutputField* values = field_of(*block, field);
  if (!values || values->on_cells) return {};
  const auto components = static_cast<std::size_t>(values->rank);
  const std::int64_t first = first_point(comm, *block), count = static_cast<std::int64_t>(block->natural_point.size());
  std::vector<double> sum(components, 0.0);
  const auto add = [&](std::size_t point, double weight) {
    for (std::size_t c = 0; c < components; ++c) sum[c] += weight * values->values[components * point + c];
  };
  for (std::size_t k = 0; k < host.points.size(); ++k) {
    const std::int64_t name = host.points[k];
    if (host.cells && name >= first && name < first + count)
      add(static_cast<std::size_t>(name - first), host.weights[k]);
    if (host.cells) continue;
    for (std::size_t p = 0; p < block->natural_point.size(); ++p)
      if (block->natural_point[p] == name) add(p, host.weights[k]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), static_cast<int>(components), MPI_DOUBLE, MPI_SUM, comm);
  return sum;
}
} // namespace pdx::record
