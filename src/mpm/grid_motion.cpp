#include "pdx/mpm/grid_motion.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/mpm/cell_points.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <string>
#include <utility>

namespace pdx::mpm {
namespace {
constexpr double kOnNode = 1e-9;       // of a cell
constexpr double kMostNodes = 1 << 23; // of one rank that has all: beyond that memory is short
constexpr double kNodesPerPoint = 16.0;

/// Numbers of cells begin where a point sees other nodes.
double begin_of(Shape shape) { return shape == Shape::hat ? 0.0 : -0.5; }
} // namespace

template <int Dim>
GridMotion<Dim>::GridMotion(MPI_Comm comm, const GridRule& rule, const Vector<Dim>& origin,
                            std::vector<BodyMaterial> bodies, std::vector<std::vector<GridPoint<Dim>>> points)
    : comm_(comm), rule_(rule), origin_(origin), bodies_(std::move(bodies)), push_(bodies_.size(), Vector<Dim>::Zero()),
      point_mass_(std::numeric_limits<double>::infinity())
{
  for (const BodyMaterial& body : bodies_)
    point_mass_ = std::min(point_mass_, body.elastic.density * point_volume<Dim>(body));
  resume(std::move(points), 0.0);
}

template <int Dim>
void GridMotion<Dim>::resume(std::vector<std::vector<GridPoint<Dim>>> points, double work, double time)
{
  time_ = time;
  points_.clear();
  bool far = false;
  try {
    for (auto& of_body : points) points_.emplace_back(begin_of(rule_.shape), std::move(of_body));
  } catch (const SolverFailure&) {
    far = true;
  }
  if (any_rank(comm_, far)) throw TooFarApart(0.0);
  work_ = work;
  lay_grid();
}

/// Nodes that points in any block see.
template <int Dim> void GridMotion<Dim>::lay_grid()
{
  Site<Dim> lower, upper;
  lower.fill(0);
  upper.fill(0);
  bool any = false;
  for (const PointLanes<Dim>& points : points_) {
    if (points.size() == 0) continue;
    for (std::size_t d = 0; d < Dim; ++d) {
      lower[d] = any ? std::min(lower[d], points.lowest()[d]) : points.lowest()[d];
      upper[d] = any ? std::max(upper[d], points.highest()[d]) : points.highest()[d];
    }
    any = true;
  }
  if (!any) upper[0] = PointLanes<Dim>::kLanes - 1;
  for (std::size_t d = 0; d < Dim; ++d) { // along x whole vectors, as blocks of cells are
    lower[d] -= d == 0 ? PointLanes<Dim>::kLanes : 1;
    upper[d] += d == 0 ? PointLanes<Dim>::kLanes : 1;
  }
  if (too_wide(lower, upper, any)) {
    double fastest = 0.0;
    for (std::size_t b = 0; b < points_.size(); ++b)
      for (const GridPoint<Dim>& p : this->points(b)) fastest = std::max(fastest, p.v.norm());
    throw TooFarApart(fastest);
  }
  nodes_ = GridNodes<Dim>(comm_, lower, upper);
  find_seen();
  share_nodes();
}

template <int Dim> void GridMotion<Dim>::share_nodes()
{
  nodes_.share(first_seen_, last_seen_);
  find_borders();
}

/// Judged as if one rank had all, so that the number of ranks changes nothing.
template <int Dim> bool GridMotion<Dim>::too_wide(const Site<Dim>& lower, const Site<Dim>& upper, bool any) const
{
  std::array<double, 2 * Dim> ends{}; // lower, and the negative of upper
  ends.fill(std::numeric_limits<double>::max());
  for (std::size_t d = 0; d < Dim && any; ++d) {
    ends[d] = lower[d];
    ends[Dim + d] = -static_cast<double>(upper[d]);
  }
  double all = 0.0, nodes = 1.0;
  for (const PointLanes<Dim>& points : points_) all += static_cast<double>(points.size());
  MPI_Allreduce(MPI_IN_PLACE, ends.data(), 2 * Dim, MPI_DOUBLE, MPI_MIN, comm_);
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_DOUBLE, MPI_SUM, comm_);
  for (std::size_t d = 0; d < Dim; ++d) nodes *= -ends[Dim + d] - ends[d] + 1.0;
  return nodes > std::max(kMostNodes, kNodesPerPoint * all);
}

template <int Dim> void GridMotion<Dim>::give_all(const Giving& what)
{
  static Event event("mpm_give");
  const Timed timed(event);
  const NodeView<Dim>& view = nodes_.view();
  std::vector<double*> lists;
  if (what.momentum) {
    lists.push_back(view.mass);
    lists.insert(lists.end(), view.velocity.begin(), view.velocity.end());
  }
  if (what.force) lists.insert(lists.end(), view.pull.begin(), view.pull.end());
  for (double* list : lists) nodes_.clear(list);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    give<Dim>(processor_, rule_, bodies_[b], what, push_[b], points_[b], view);
  nodes_.add_up(lists);
}

template <int Dim> void GridMotion<Dim>::take_all(const Taking& what)
{
  static Event event("mpm_take");
  const Timed timed(event);
  const NodeView<Dim>& view = nodes_.view();
  if (what.giving)
    for (double* list : view.brought) nodes_.clear(list);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    work_ += push_[b].dot(take<Dim>(processor_, rule_, bodies_[b], what, points_[b], view));
  if (what.giving) nodes_.add_up(view.brought);
}

template <int Dim> void GridMotion<Dim>::settle_velocity(bool momentum, bool force, double kick)
{
  const NodeView<Dim>& view = nodes_.view();
  for (std::size_t d = 0; d < Dim; ++d)
    settle_nodes(processor_, nodes_.mass(), point_mass_, kick, view.velocity[d], force ? view.pull[d] : nullptr,
                 !momentum, true);
}

template <int Dim>
void GridMotion<Dim>::hold_nodes(double time, double kick, bool force, bool brought, const Layers& layers)
{
  const NodeView<Dim>& view = nodes_.view();
  for (std::size_t k = 0; k < holds_.size(); ++k) {
    const GridHold<Dim>& hold = holds_[k];
    const auto axis = static_cast<std::size_t>(hold.axis);
    const double shift = hold.velocity ? hold.velocity(time) : 0.0, turn = hold.spin ? hold.spin(time) : 0.0;
    Site<Dim> from, to;
    bool any = true;
    for (std::size_t d = 0; d < Dim; ++d) {
      const auto a = static_cast<Eigen::Index>(d);
      const double low = std::ceil((hold.box.lower[a] - origin_[a]) / rule_.side - kOnNode),
                   high = std::floor((hold.box.upper[a] - origin_[a]) / rule_.side + kOnNode);
      from[d] = static_cast<Index>(std::max<double>(low, nodes_.lower()[d]));
      to[d] = static_cast<Index>(std::min<double>(high, nodes_.upper()[d]));
      if (d == Dim - 1) {
        from[d] = std::max(from[d], layers.from);
        to[d] = std::min(to[d], layers.to);
      }
      any = any && low <= nodes_.upper()[d] && high >= nodes_.lower()[d] && from[d] <= to[d];
    }
    if (!any) continue;
    for (Site<Dim> node = from;;) {
      const std::size_t at = nodes_.number(node);
      Vector<Dim> place = origin_;
      for (std::size_t d = 0; d < Dim; ++d) place[static_cast<Eigen::Index>(d)] += rule_.side * node[d];
      const double v = hold.at(place, shift, turn);
      if (hold.along)
        roll_node(k, at, kick, force, brought);
      else if (brought)
        view.brought[axis][at] = v;
      else {
        if (force && view.mass[at] > 0.0) {
          const double before = view.velocity[axis][at], change = v - before; // over the kick
          if (nodes_.owned(at)) {
            const double pull = view.mass[at] * change / kick;
            hold_force_[k] += pull;
            work_ += pull * v * kick;
          }
          view.pull[axis][at] += change / kick;
        }
        view.velocity[axis][at] = v;
      }
      std::size_t d = 0;
      for (; d < Dim && ++node[d] > to[d]; ++d) node[d] = from[d];
      if (d == Dim) break;
    }
  }
}

/// A node that does not move along a direction, whatever it does across it.
template <int Dim>
void GridMotion<Dim>::roll_node(std::size_t hold, std::size_t at, double kick, bool force, bool brought)
{
  const NodeView<Dim>& view = nodes_.view();
  const Vector<Dim>& along = *holds_[hold].along;
  const auto take_out = [&](const auto& lists) {
    double before = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) before += along[static_cast<Eigen::Index>(d)] * lists[d][at];
    for (std::size_t d = 0; d < Dim; ++d) lists[d][at] -= before * along[static_cast<Eigen::Index>(d)];
    return before;
  };
  if (brought) {
    (void)take_out(view.brought);
    return;
  }
  const double before = take_out(view.velocity);
  if (!force || view.mass[at] <= 0.0) return;
  if (nodes_.owned(at)) hold_force_[hold] -= view.mass[at] * before / kick;
  for (std::size_t d = 0; d < Dim; ++d) view.pull[d][at] -= before * along[static_cast<Eigen::Index>(d)] / kick;
}

template <int Dim> void GridMotion<Dim>::step(double time, double length, double kick)
{
  const double end = time_ = time + length;
  hold_force_.assign(holds_.size(), 0.0);
  if (rule_.order == Order::usf) {
    give_all({.momentum = true});
    settle_velocity(true, false, 0.0);
    hold_nodes(time, kick, false, false);
    take_all({.strain = true, .step = length});
    give_all({.force = true});
    settle_velocity(false, true, kick);
    hold_nodes(end, kick, true, false);
    take_all({.velocity = true, .place = true, .step = length, .kick = kick});
  } else if (rule_.order == Order::usl) {
    give_all({.momentum = true, .force = true});
    settle_velocity(true, true, kick);
    hold_nodes(end, kick, true, false);
    take_all({.velocity = true, .strain = true, .place = true, .step = length, .kick = kick});
  } else {
    musl_step(end, length, kick);
  }
  regroup();
}

template <int Dim> const std::vector<PointLanes<Dim>>& GridMotion<Dim>::ended(double half)
{
  ended_ = points_;
  const std::vector<double> forces = hold_force_;
  const double work = work_, pic = std::exchange(rule_.pic, 0.0);
  hold_force_.assign(holds_.size(), 0.0);
  give_all({.momentum = true, .force = true});
  settle_velocity(true, true, half);
  hold_nodes(time_, half, true, false);
  take_all({.velocity = true, .giving = true, .kick = half});
  hold_force_ = forces;
  work_ = work;
  rule_.pic = pic;
  std::swap(points_, ended_);
  return ended_;
}

/// What ended a step. Collective.
/// @param why what this rank says, if anything   @param speed of its fastest point, if that may be the cause [m/s]
template <int Dim> std::string GridMotion<Dim>::failure(const std::string& why, double speed) const
{
  double sound = 0.0;
  for (const BodyMaterial& body : bodies_)
    sound = std::max(sound, std::sqrt(law_tangent<Dim>(body, Tensor<Dim>::Zero())(0, 0) / body.elastic.density));
  MPI_Allreduce(MPI_IN_PLACE, &speed, 1, MPI_DOUBLE, MPI_MAX, comm_);
  if (speed > sound) {
    const bool known = rule_.order == Order::usl && rule_.shape == Shape::hat;
    return fmt::format("the motion has blown up, a material point flies at {:.3g} m/s, {:.3g} times the speed of "
                       "sound{}",
                       speed, speed / sound,
                       known ? " (-mpm_order usl does so with -mpm_shape hat, where nodes have little mass: give musl)"
                             : "");
  }
  return why.empty() ? "material points have left for nowhere" : why;
}

template <int Dim> void GridMotion<Dim>::regroup()
{
  static Event event("mpm_regroup");
  const Timed timed(event);
  enum Change { none, seen, blocks, lost };
  int change = none;
  bool refilled = false;
  std::string why;
  double speed = 0.0;
  try {
    for (PointLanes<Dim>& points : points_) change = points.regroup() ? change : blocks;
    if (change == none) {
      const std::pair before(first_seen_, last_seen_);
      refilled = find_seen();
      if (before != std::pair(first_seen_, last_seen_)) change = seen;
    }
  } catch (const TooFarApart& far) {
    why = far.what();
    speed = far.speed;
    change = lost;
  } catch (const SolverFailure& nowhere) {
    why = nowhere.what();
    change = lost;
  }
  MPI_Allreduce(MPI_IN_PLACE, &change, 1, MPI_INT, MPI_MAX, comm_);
  if (change == lost) throw SolverFailure(failure(why, speed));
  if (change == blocks) {
    try {
      lay_grid();
    } catch (const TooFarApart& far) {
      throw SolverFailure(failure(far.what(), far.speed));
    }
  } else if (change == seen)
    share_nodes();
  else if (refilled)
    find_borders();
}

template <int Dim> PointEnergies GridMotion<Dim>::energies() const
{
  PointEnergies sums;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const PointEnergies of_body = energies_of<Dim>(processor_, bodies_[b], points_[b]);
    sums.strain += of_body.strain;
    sums.kinetic += of_body.kinetic;
  }
  return sums;
}

template <int Dim> std::vector<GridPoint<Dim>> GridMotion<Dim>::points(std::size_t body) const
{
  return points_[body].points();
}

template class GridMotion<2>;
template class GridMotion<3>;
} // namespace pdx::mpm
