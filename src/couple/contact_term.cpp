#include "pdx/couple/contact_term.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace pdx::couple {
namespace {
/// Everybody's surface points of bodies that may touch, ascending by name.
template <int Dim> struct GatheredSurface {
  std::vector<SkinPoint<Dim>> points;
  std::vector<Host> hosts;

  GatheredSurface(MPI_Comm comm, std::span<const SurfacePoint<Dim>> mine, const ContactLaw<Dim>& law)
  {
    struct Record {
      std::uint64_t name;
      Index body;
      std::array<double, Dim> place;
      double size;
    };
    std::vector<Record> records;
    std::vector<Host> carriers;
    for (const SurfacePoint<Dim>& point : mine) {
      if (!law.touches_any(point.at.body)) continue;
      Record record{point.at.name, point.at.body, {}, point.at.size};
      std::copy_n(point.at.place.data(), Dim, record.place.begin());
      records.push_back(record);
      carriers.push_back(point.host);
    }
    records = gather_all(comm, records);
    carriers = gather_all(comm, carriers);
    std::vector<std::size_t> order(records.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t k) { return records[k].name; });
    for (const std::size_t k : order) {
      const Record& r = records[k];
      if (!points.empty() && points.back().name == r.name) throw std::logic_error("two surface points have one name");
      points.push_back({r.name, r.body, Eigen::Map<const Vector<Dim>>(r.place.data()), r.size});
      hosts.push_back(carriers[k]);
    }
  }
};

bool before(const auto& a, const auto& b) { return a.point != b.point ? a.point < b.point : a.body < b.body; }
} // namespace

template <int Dim>
ContactTerm<Dim>::ContactTerm(const field::Rows& rows, std::span<const SurfacePoint<Dim>> mine,
                              std::vector<ContactBody> bodies, ContactOptions options)
    : rows_(rows), law_(std::move(bodies), std::move(options)), pair_forces_(law_.pairs().size(), Vector<Dim>::Zero()),
      depths_(law_.pairs().size(), 0.0), approaches_(depths_)
{
  GatheredSurface<Dim> all(rows.comm, mine, law_);
  skin_ = ContactSkin<Dim>(std::move(all.points), static_cast<Index>(law_.bodies().size()));
  offsets_ = start_offsets(skin_, law_);
  const auto is_mine = [&](const Host& host) {
    return std::any_of(host.rows.begin(), host.rows.begin() + host.count,
                       [&](PetscInt row) { return rows_.owns(row); });
  };
  if (std::ranges::none_of(all.hosts, is_mine)) {
    skin_ = ContactSkin<Dim>({}, static_cast<Index>(law_.bodies().size()));
    return;
  }
  for (const Host& host : all.hosts) {
    points_.add(host);
    mine_.push_back(is_mine(host));
    counted_.push_back(rows_.owns(host.rows[0]));
    largest_weight_ =
        std::max(largest_weight_, std::accumulate(host.weights.begin(), host.weights.begin() + host.count, 0.0,
                                                  [](double s, double w) { return s + std::abs(w); }));
  }
  for (const SkinPoint<Dim>& point : skin_.points()) beyond_ = std::max(beyond_, law_.options().skin * point.size);
  x_.resize(skin_.points().size());
  forces_.resize(skin_.points().size());
}

template <int Dim> void ContactTerm<Dim>::needed_rows(std::vector<PetscInt>& rows) const
{
  rows.insert(rows.end(), points_.all_rows().begin(), points_.all_rows().end());
}

template <int Dim> void ContactTerm<Dim>::bind(const field::RowHalo& halo)
{
  points_.bind(halo);
  local_size_ = static_cast<std::size_t>(halo.size()) * Dim;
  surface_rows_ = points_.all_rows();
  std::ranges::sort(surface_rows_);
  const auto repeated = std::ranges::unique(surface_rows_);
  surface_rows_.erase(repeated.begin(), repeated.end());
  listed_at_.assign(surface_rows_.size() * Dim, 0.0);
}

template <int Dim> void ContactTerm<Dim>::place(std::span<const double> u, Index point) const
{
  x_[static_cast<std::size_t>(point)] = skin_.point(point).place + points_.displacement(point, u);
}

/// The farthest that a surface point may have moved since the last search [m].
template <int Dim> double ContactTerm<Dim>::moved(std::span<const double> u) const
{
  double most2 = 0.0;
  for (std::size_t k = 0; k < surface_rows_.size(); ++k) {
    const double* now = u.data() + static_cast<std::size_t>(surface_rows_[k]) * Dim;
    const double* then = listed_at_.data() + k * Dim;
    double sum = 0.0;
    for (int d = 0; d < Dim; ++d) sum += (now[d] - then[d]) * (now[d] - then[d]);
    most2 = std::max(most2, sum);
  }
  return largest_weight_ * std::sqrt(most2);
}

/// Brings the list, and the places of what is in it, to the displacement u.
template <int Dim> void ContactTerm<Dim>::follow(std::span<const double> u) const
{
  if (listed_ && moved(u) <= list_.slack()) {
    for (const Index point : list_.points()) place(u, point);
    return;
  }
  static Event event("contact_search");
  const Timed timed(event);
  for (Index point = 0; point < points(); ++point) place(u, point);
  const bool rubs = law_.options().friction > 0.0; // all ranks follow all grips
  list_.renew(skin_, law_, x_, rubs ? std::span<const std::uint8_t>{} : mine_, beyond_);
  for (const Grip<Dim>& grip : grips_) list_.join(grip.points);
  for (std::size_t k = 0; k < surface_rows_.size(); ++k)
    std::copy_n(u.data() + static_cast<std::size_t>(surface_rows_[k]) * Dim, Dim, listed_at_.data() + k * Dim);
  listed_ = true;
  note_approach();
}

/// Steps are told by forces, one each; where the list was not searched before, nothing is known.
template <int Dim> void ContactTerm<Dim>::note_approach() const
{
  const std::span<const double> now = list_.gaps();
  for (std::size_t k = 0; k < gaps_.size() && forces_since_ > 0; ++k) {
    if (!std::isfinite(now[k])) continue;
    const auto [a, b] = law_.pairs()[k];
    const double d0 = 0.5 * (skin_.sizes(a).front() + skin_.sizes(b).front());
    approaches_[k] = std::max(approaches_[k], (gaps_[k] - now[k]) / (forces_since_ * d0));
  }
  gaps_.assign(now.begin(), now.end());
  forces_since_ = 0;
}

template <int Dim> double ContactTerm<Dim>::offset(const Near& near) const
{
  if (offsets_.empty()) return 0.0;
  const auto at = std::ranges::lower_bound(offsets_, near, [](const auto& a, const auto& b) { return before(a, b); });
  return at != offsets_.end() && at->point == near.point && at->body == near.body ? at->less : 0.0;
}

/// k of a point against a body's skin.
template <int Dim> double ContactTerm<Dim>::stiffness(Index point, Index body) const
{
  const SkinPoint<Dim>& p = skin_.point(point);
  return law_.stiffness(p.body, p.size, body, skin_.sizes(body).back());
}

/// Calls visit(near, touch, stiffness, traction or null) where something touches, in an order that is alike on any
/// number of ranks, and let_go(grip) for the grips of what does not touch any more.
template <int Dim>
template <class Visit, class LetGo>
void ContactTerm<Dim>::for_each_touch(Visit&& visit, LetGo&& let_go) const
{
  const double friction = law_.options().friction;
  auto grip = grips_.begin();
  for (const Near& near : list_.near()) {
    const Touch<Dim> touch = deepest_touch<Dim>(skin_, list_.facets(near), x_, near.point, offset(near));
    if (touch.facet < 0) continue;
    const double k = stiffness(near.point, near.body);
    if (friction == 0.0) {
      visit(near, touch, k, static_cast<const Traction<Dim>*>(nullptr));
      continue;
    }
    for (; grip != grips_.end() && before(*grip, near); ++grip) let_go(*grip);
    const bool sticks = grip != grips_.end() && !before(near, *grip);
    const double limit = friction * touch.overlap / ContactLaw<Dim>::kStick;
    const auto traction = traction_of<Dim>(skin_, touch, x_, near.point, sticks ? &*grip : nullptr, limit);
    visit(near, touch, k, traction ? &*traction : nullptr);
    if (sticks && traction) ++grip;
  }
  for (; grip != grips_.end(); ++grip) let_go(*grip);
}

template <int Dim> void ContactTerm<Dim>::add_residual(std::span<const double> u, std::span<double> r) const
{
  std::ranges::fill(pair_forces_, Vector<Dim>::Zero());
  next_grips_.clear();
  slip_work_ = 0.0;
  if (points() == 0) return;
  ++forces_since_;
  follow(u);
  if (list_.near().empty() && grips_.empty()) return;
  static Event event("contact_force");
  const Timed timed(event);
  for (const Index p : list_.points()) forces_[static_cast<std::size_t>(p)].setZero();
  for_each_touch([&](const Near& near, const Touch<Dim>& touch, double k,
                     const Traction<Dim>* traction) { push(near, touch, k, traction); },
                 [&](const Grip<Dim>& grip) { let_go(grip); });
  for (const Index p : list_.points())
    if (mine_[static_cast<std::size_t>(p)])
      points_.add_force(p, forces_[static_cast<std::size_t>(p)], rows_.owned(), r);
}

/// Adds the forces of a touch.
template <int Dim>
void ContactTerm<Dim>::push(const Near& near, const Touch<Dim>& touch, double k, const Traction<Dim>* traction) const
{
  const auto& facet = skin_.facet(touch.facet);
  Vector<Dim> force = -k * touch.overlap * touch.normal; // derivative of k (d0 - d)^2 / 2
  forces_[static_cast<std::size_t>(near.point)] += force;
  for (std::size_t c = 0; c < static_cast<std::size_t>(facet.count); ++c)
    forces_[static_cast<std::size_t>(facet.points[c])] -= touch.weights[c] * force;
  const double stick = ContactLaw<Dim>::kStick * k;
  if (traction) {
    traction->add_forces(stick, forces_);
    force += stick * traction->tau;
    next_grips_.push_back(traction->grip);
  }
  if (!counts(near.point)) return;
  if (traction) slip_work_ += stick * traction->slip_energy;
  const Index body = skin_.point(near.point).body;
  const auto at = static_cast<std::size_t>(law_.pair(body, near.body));
  depths_[at] = std::max(depths_[at], touch.overlap / (touch.overlap + touch.distance));
  Vector<Dim>& pair = pair_forces_[at];
  pair += body < near.body ? Vector<Dim>(-force) : force;
}

/// What its spring held is lost.
template <int Dim> void ContactTerm<Dim>::let_go(const Grip<Dim>& grip) const
{
  const double k = ContactLaw<Dim>::kStick * stiffness(grip.point, grip.body);
  if (counts(grip.point)) slip_work_ += 0.5 * k * grip.stretch * grip.stretch;
}

template <int Dim> double ContactTerm<Dim>::energy(std::span<const double> u) const
{
  if (points() == 0) return 0.0;
  follow(u);
  double sum = 0.0;
  for_each_touch(
      [&](const Near& near, const Touch<Dim>& touch, double k, const Traction<Dim>* traction) {
        if (!counts(near.point)) return;
        sum += 0.5 * k * touch.overlap * touch.overlap;
        if (traction) sum += 0.5 * ContactLaw<Dim>::kStick * k * traction->tau.squaredNorm();
      },
      [](const Grip<Dim>&) {});
  return sum;
}

namespace {
constexpr double kAlmost = 2.0 * kTouching; // of a size: as near is in touch

[[noreturn]] void refuse_tangent() { throw std::logic_error("friction between bodies has no tangent"); }
} // namespace

template <int Dim> void ContactTerm<Dim>::couplings(field::Couplings& couplings, bool) const
{
  if (law_.options().friction > 0.0) refuse_tangent();
  if (points() == 0) return;
  follow(std::vector<double>(local_size_, 0.0));
  std::vector<Index> rows;
  for (const Near& near : list_.near()) {
    const auto take = [&](Index point) {
      rows.insert(rows.end(), points_.rows(point).begin(), points_.rows(point).end());
    };
    rows.clear();
    take(near.point);
    for (const Index facet : list_.facets(near))
      for (int c = 0; c < skin_.facet(facet).count; ++c) take(skin_.facet(facet).points[static_cast<std::size_t>(c)]);
    std::ranges::sort(rows);
    const auto repeated = std::ranges::unique(rows);
    rows.erase(repeated.begin(), repeated.end());
    for (const Index row : rows)
      for (const Index column : rows) couplings.add(row, column);
  }
}

template <int Dim> void ContactTerm<Dim>::add_jacobian(field::BlockAdder& adder, bool) const
{
  if (law_.options().friction > 0.0) refuse_tangent();
  PDX_CALL(MatSetOption(adder.matrix(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  if (points() == 0) return;
  static Event event("contact_jacobian");
  const Timed timed(event);
  follow(linearised_);
  for (const Near& near : list_.near()) { // what touches without a force, too: it will push if it comes nearer
    const double less = offset(near) - kAlmost * skin_.point(near.point).size;
    const Touch<Dim> touch = deepest_touch<Dim>(skin_, list_.facets(near), x_, near.point, less);
    if (touch.facet >= 0) add_tangent(near, touch, stiffness(near.point, near.body), adder);
  }
}

/// What the places of a touch have of each other, handed on to the rows that carry them.
template <int Dim>
void ContactTerm<Dim>::add_tangent(const Near& near, const Touch<Dim>& touch, double k, field::BlockAdder& adder) const
{
  const auto& facet = skin_.facet(touch.facet);
  std::vector<Index> places{near.point}, rows;
  std::vector<Vector<Dim>> corners;
  for (std::size_t c = 0; c < static_cast<std::size_t>(facet.count); ++c) {
    places.push_back(facet.points[c]);
    corners.push_back(x_[static_cast<std::size_t>(facet.points[c])]);
  }
  const ContactMatrix<Dim> tangent = contact_tangent<Dim>(touch, corners, k);
  std::vector<std::pair<Eigen::Index, double>> carriers; // of each row: its place, and how much of it
  for (std::size_t p = 0; p < places.size(); ++p)
    for (std::size_t n = 0; n < points_.rows(places[p]).size(); ++n) {
      rows.push_back(points_.rows(places[p])[n]);
      carriers.emplace_back(static_cast<Eigen::Index>(p), points_.weights(places[p])[n]);
    }
  const std::size_t width = rows.size() * Dim;
  std::vector<double> panel(width * width);
  for (std::size_t r = 0; r < width; ++r)
    for (std::size_t c = 0; c < width; ++c) {
      const auto& [a, of_a] = carriers[r / Dim];
      const auto& [b, of_b] = carriers[c / Dim];
      panel[r * width + c] =
          of_a * of_b *
          tangent(Dim * a + static_cast<Eigen::Index>(r % Dim), Dim * b + static_cast<Eigen::Index>(c % Dim));
    }
  adder.add(rows, rows, panel);
}

template <int Dim> void ContactTerm<Dim>::add_stiffness_bound(std::span<double> blocks) const
{
  constexpr std::size_t kAtOnce = 2; // other bodies at one point
  for (Index p = 0; p < points(); ++p) {
    if (!mine_[static_cast<std::size_t>(p)]) continue;
    const SkinPoint<Dim>& point = skin_.point(p);
    std::vector<double> bounds; // per other body
    for (Index body = 0; body < static_cast<Index>(law_.bodies().size()); ++body) {
      if (!law_.may_touch(point.body, body)) continue;
      double most = 0.0;
      for (const double size : skin_.sizes(body))
        most = std::max(most, law_.stiffness_bound(point.body, point.size, body, size));
      bounds.push_back(most);
    }
    std::ranges::sort(bounds, std::greater<>());
    const double bound = std::accumulate(
        bounds.begin(), bounds.begin() + static_cast<std::ptrdiff_t>(std::min(kAtOnce, bounds.size())), 0.0);
    const std::span<const double> weights = points_.tied_weights(p);
    double sum = 0.0;
    for (const double w : weights) sum += std::abs(w);
    for (std::size_t k = 0; k < weights.size(); ++k)
      if (const Index row = points_.rows(p)[k]; row < rows_.owned())
        for (std::size_t d = 0; d < Dim; ++d)
          blocks[static_cast<std::size_t>(row) * Dim * Dim + d * (Dim + 1)] += bound * sum * std::abs(weights[k]);
  }
}

template <int Dim> double ContactTerm<Dim>::slip()
{
  grips_.swap(next_grips_);
  next_grips_.clear();
  const double work = slip_work_;
  slip_work_ = 0.0;
  return work;
}

template <int Dim> std::vector<NamedGrip<Dim>> ContactTerm<Dim>::grips() const
{
  std::vector<NamedGrip<Dim>> named;
  for (const Grip<Dim>& grip : grips_) {
    if (!counts(grip.point)) continue;
    NamedGrip<Dim> by_name{
        skin_.point(grip.point).name, static_cast<std::uint64_t>(grip.body), {}, grip.weights, grip.stretch};
    for (std::size_t k = 0; k < Dim; ++k) by_name.points[k] = skin_.point(grip.points[k]).name;
    named.push_back(by_name);
  }
  return named;
}

template <int Dim> void ContactTerm<Dim>::set_grips(std::span<const NamedGrip<Dim>> named)
{
  const auto number = [&](std::uint64_t name) {
    const auto at = std::ranges::lower_bound(skin_.points(), name, {}, &SkinPoint<Dim>::name);
    return at != skin_.points().end() && at->name == name ? static_cast<Index>(at - skin_.points().begin()) : Index{-1};
  };
  grips_.clear();
  for (const NamedGrip<Dim>& by_name : named) {
    Grip<Dim> grip{number(by_name.point), static_cast<Index>(by_name.body), {}, by_name.weights, by_name.stretch};
    std::ranges::transform(by_name.points, grip.points.begin(), number);
    if (grip.point >= 0 && std::ranges::min(grip.points) >= 0) grips_.push_back(grip);
  }
  std::ranges::sort(grips_, [](const auto& a, const auto& b) { return before(a, b); });
  save();
  listed_ = false;
}

template class ContactTerm<2>;
template class ContactTerm<3>;
} // namespace pdx::couple
