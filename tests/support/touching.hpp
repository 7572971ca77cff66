#pragma once
#include "pdx/couple/carried_bonds.hpp"
#include "pdx/couple/contact_books.hpp"
#include "pdx/field/system.hpp"
#include "support/inert_term.hpp"

#include <cmath>
#include <functional>

namespace pdx::test {
/// A box of points on a lattice that springs hold together: masses themselves, or carried by masses on the corners of
/// cells of 2 x 2 (x 2) points.
template <int Dim> struct TouchingBody {
  std::string name;
  Vector<Dim> corner; ///< lower left one of its squares or cubes [m]
  Site<Dim> count;    ///< points per direction; even where carried
  double dx = 1.0, young = 1.0, density = 1.0;
  bool carried = false, held = false;
  Vector<Dim> velocity = Vector<Dim>::Zero();
  double turn = 0.0; ///< about its corner, in the plane of x and y [rad]
};

/// Bodies that may touch, their rows dealt out to the ranks like cards.
template <int Dim> struct Touching {
  using Body = TouchingBody<Dim>;
  struct Row {
    Index body;
    Vector<Dim> x;
    double mass;
  };

  Touching(MPI_Comm comm, std::vector<Body> given, couple::ContactOptions options = {}) : bodies(std::move(given))
  {
    MPI_Comm_size(comm, &ranks);
    MPI_Comm_rank(comm, &rank);
    for (std::size_t b = 0; b < bodies.size(); ++b) add_rows(static_cast<Index>(b));
    number(comm);
    add_springs();
    system.terms.push_back(std::make_unique<Masses>(*this));
    std::vector<couple::ContactBody> partners;
    for (const Body& body : bodies) partners.push_back({body.name, body.young});
    for (std::size_t b = 0; b < bodies.size(); ++b) add_surface(static_cast<Index>(b));
    auto term = std::make_unique<couple::ContactTerm<Dim>>(system.rows, surface, partners, std::move(options));
    contact = term.get();
    system.terms.push_back(std::move(term));
    auto step = std::make_unique<couple::ContactStep<Dim>>(*contact);
    books = step.get();
    system.after_step.push_back(std::move(step));
    hold();
    system.bind();
  }

  /// Local blocks [owned | halo] of a displacement of rows.
  std::vector<double> blocks(const std::function<Vector<Dim>(const Row&)>& u) const
  {
    std::vector<double> owned, all;
    for (const std::size_t k : mine) {
      const Vector<Dim> value = u(rows[k]);
      owned.insert(owned.end(), value.data(), value.data() + Dim);
    }
    system.halo->fetch(owned, Dim, all);
    return all;
  }
  /// Of all rows, in order of `rows`, on every rank. Collective.
  std::vector<double> of_all(std::span<const double> owned) const
  {
    std::vector<double> all(rows.size() * Dim, 0.0);
    for (std::size_t k = 0; k < mine.size(); ++k)
      std::copy_n(owned.begin() + static_cast<std::ptrdiff_t>(k * Dim), Dim,
                  all.begin() + static_cast<std::ptrdiff_t>(mine[k] * Dim));
    MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, system.rows.comm);
    return all;
  }
  /// Contact's part of the internal force of all rows [N]. Collective.
  std::vector<double> contact_force(std::span<const double> u) const
  {
    std::vector<double> r(mine.size() * Dim, 0.0);
    contact->add_residual(u, r);
    return of_all(r);
  }
  double sum(double value) const
  {
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, system.rows.comm);
    return value;
  }
  /// On body a by body b at the last force [N]. Collective.
  Vector<Dim> push(Index a, Index b) const
  {
    Vector<Dim> force = contact->pair_forces()[static_cast<std::size_t>(contact->law().pair(a, b))];
    MPI_Allreduce(MPI_IN_PLACE, force.data(), Dim, MPI_DOUBLE, MPI_SUM, system.rows.comm);
    return a < b ? force : Vector<Dim>(-force);
  }
  /// @param rise that gravity takes to come up [s]
  void weigh_down(const Vector<Dim>& gravity, double rise)
  {
    field::Drive drive{field::Drive::Kind::force, field::History::ramp(0.0, rise), {}, {}};
    for (std::size_t k = 0; k < mine.size() * Dim; ++k) {
      drive.components.push_back(static_cast<Index>(k));
      drive.values.push_back(rows[mine[k / Dim]].mass * gravity[static_cast<Eigen::Index>(k % Dim)]);
    }
    system.drives.push_back(std::move(drive));
  }
  Vector<Dim> mean(std::span<const double> owned, Index body) const
  {
    Vector<Dim> total = Vector<Dim>::Zero();
    double weight = 0.0;
    for (std::size_t k = 0; k < mine.size(); ++k)
      if (rows[mine[k]].body == body) {
        total += rows[mine[k]].mass * Eigen::Map<const Vector<Dim>>(owned.data() + k * Dim);
        weight += rows[mine[k]].mass;
      }
    MPI_Allreduce(MPI_IN_PLACE, total.data(), Dim, MPI_DOUBLE, MPI_SUM, system.rows.comm);
    return total / sum(weight);
  }

  std::vector<Body> bodies;
  std::vector<Row> rows;                          // of all ranks
  std::vector<std::size_t> mine;                  // places in rows, in order of owned rows
  std::vector<PetscInt> global;                   // row number of each
  std::vector<couple::SurfacePoint<Dim>> surface; // of this rank
  int rank = 0, ranks = 1;
  field::System system;
  couple::ContactTerm<Dim>* contact = nullptr;
  couple::ContactStep<Dim>* books = nullptr;

private:
  class Masses final : public InertTerm {
  public:
    explicit Masses(const Touching& scene) : scene_(scene) {}
    void add_mass(std::span<double> mass) const override
    {
      for (std::size_t k = 0; k < scene_.mine.size(); ++k) mass[k] += scene_.rows[scene_.mine[k]].mass;
    }

  private:
    const Touching& scene_;
  };

  template <class Visit> static void for_each_site(const Site<Dim>& count, Visit&& visit)
  {
    Site<Dim> site{};
    for (bool more = true; more;) {
      visit(site);
      more = false;
      for (std::size_t d = 0; d < Dim && !more; ++d) {
        more = ++site[d] < count[d];
        if (!more) site[d] = 0;
      }
    }
  }
  static Vector<Dim> turned(const Body& body, const Vector<Dim>& from_corner)
  {
    Vector<Dim> x = from_corner;
    x[0] = std::cos(body.turn) * from_corner[0] - std::sin(body.turn) * from_corner[1];
    x[1] = std::sin(body.turn) * from_corner[0] + std::cos(body.turn) * from_corner[1];
    return body.corner + x;
  }
  static double spacing(const Body& body) { return body.carried ? 2.0 * body.dx : body.dx; }
  static Site<Dim> count_of_rows(const Body& body)
  {
    Site<Dim> count = body.count;
    if (body.carried)
      for (Index& n : count) n = n / 2 + 1;
    return count;
  }

  void add_rows(Index number)
  {
    const Body& body = bodies[static_cast<std::size_t>(number)];
    first_.push_back(rows.size());
    for_each_site(count_of_rows(body), [&](const Site<Dim>& site) {
      Vector<Dim> x;
      double mass = body.density * std::pow(spacing(body), Dim);
      for (std::size_t d = 0; d < Dim; ++d) {
        x[static_cast<Eigen::Index>(d)] = spacing(body) * (site[d] + (body.carried ? 0.0 : 0.5));
        if (body.carried && (site[d] == 0 || site[d] == body.count[d] / 2)) mass *= 0.5;
      }
      rows.push_back({number, turned(body, x), mass});
    });
  }
  void number(MPI_Comm comm)
  {
    const auto owner = [&](std::size_t k) { return static_cast<int>(k / 5) % ranks; };
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (owner(k) == rank) mine.push_back(k);
    system.rows = field::Rows::number(comm, Dim, 0, 0, static_cast<Index>(mine.size()));
    global.assign(rows.size(), 0);
    std::vector<PetscInt> next(static_cast<std::size_t>(ranks), 0);
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (int r = owner(k) + 1; r < ranks; ++r) ++next[static_cast<std::size_t>(r)];
    for (std::size_t k = 0; k < rows.size(); ++k) global[k] = next[static_cast<std::size_t>(owner(k))]++;
    for (const std::size_t k : mine) {
      system.coordinates.insert(system.coordinates.end(), rows[k].x.data(), rows[k].x.data() + Dim);
      const Vector<Dim>& v = bodies[static_cast<std::size_t>(rows[k].body)].velocity;
      system.initial_velocity.insert(system.initial_velocity.end(), v.data(), v.data() + Dim);
    }
  }
  /// Between neighbours and corner to corner, each with half of E times the spacing (in space).
  void add_springs()
  {
    couple::CarriedPoints<Dim> points;
    std::vector<couple::CarriedBond<Dim>> bonds;
    for (std::size_t a = 0; a < rows.size(); ++a)
      for (std::size_t b = a + 1; b < rows.size() && rows[b].body == rows[a].body; ++b) {
        const Body& body = bodies[static_cast<std::size_t>(rows[a].body)];
        const Vector<Dim> xi = rows[b].x - rows[a].x;
        const double h = spacing(body);
        if (xi.norm() > 1.5 * h || !(system.rows.owns(global[a]) || system.rows.owns(global[b]))) continue;
        const Index p = points.add(couple::Host::of_row(global[a])), q = points.add(couple::Host::of_row(global[b]));
        const double stiffness = 0.5 * body.young * (Dim == 2 ? 1.0 : h);
        bonds.push_back({p, q, p, q, xi, stiffness * xi.norm()});
      }
    system.terms.push_back(std::make_unique<couple::CarriedBonds<Dim>>(system.rows, std::move(points), std::move(bonds),
                                                                       law::Kinematics::finite, true));
  }
  void add_surface(Index number)
  {
    const Body& body = bodies[static_cast<std::size_t>(number)];
    const Site<Dim> nodes = count_of_rows(body);
    const auto row_at = [&](const Site<Dim>& site) {
      std::size_t place = 0;
      for (std::size_t d = Dim; d-- > 0;)
        place = place * static_cast<std::size_t>(nodes[d]) + static_cast<std::size_t>(site[d]);
      return global[first_[static_cast<std::size_t>(number)] + place];
    };
    std::uint64_t name = static_cast<std::uint64_t>(number) << 32;
    for_each_site(body.count, [&](const Site<Dim>& site) {
      ++name;
      bool outer = false;
      Vector<Dim> x;
      for (std::size_t d = 0; d < Dim; ++d) {
        outer = outer || site[d] == 0 || site[d] + 1 == body.count[d];
        x[static_cast<Eigen::Index>(d)] = body.dx * (site[d] + 0.5);
      }
      if (!outer) return;
      couple::Host host;
      for (std::size_t c = 0; c < (body.carried ? 1U << Dim : 1U); ++c) {
        Site<Dim> corner = site;
        double weight = 1.0;
        for (std::size_t d = 0; d < Dim && body.carried; ++d) {
          const bool upper = c >> d & 1U;
          corner[d] = site[d] / 2 + (upper ? 1 : 0);
          weight *= (site[d] % 2 == 1) == upper ? 0.75 : 0.25;
        }
        (void)host.add(row_at(corner), weight);
      }
      if (system.rows.owns(host.rows[0])) surface.push_back({{name, number, turned(body, x), body.dx}, host});
    });
  }
  void hold()
  {
    field::Drive still{field::Drive::Kind::displacement, field::History(), {}, {}};
    for (std::size_t k = 0; k < mine.size(); ++k)
      for (Index d = 0; d < Dim && bodies[static_cast<std::size_t>(rows[mine[k]].body)].held; ++d) {
        system.prescribed.components.push_back(static_cast<Index>(k) * Dim + d);
        system.prescribed.values.push_back(0.0);
      }
    still.components = system.prescribed.components;
    still.values = system.prescribed.values;
    system.drives.push_back(std::move(still));
  }

  std::vector<std::size_t> first_; // of each body's rows
};
} // namespace pdx::test
