#pragma once
#include "pdx/field/system.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace pdx::test {
/// A spring from an owned row to the ground that acts along a unit vector and breaks for good beyond a stretch.
struct Spring {
  Index row;
  std::array<double, 2> along;
  double stiffness; ///< [N/m]
  double limit;     ///< largest (u . along) [m]
  bool broken = false;

  double stretch(std::span<const double> u) const
  {
    const auto at = static_cast<std::size_t>(2 * row);
    return u[at] * along[0] + u[at + 1] * along[1];
  }
};
constexpr double kUnbreakable = 1e300; // [m]

/// Springs of this rank: the Term that pulls and the AfterSolve that breaks.
class Springs final : public field::Term {
public:
  explicit Springs(std::vector<Spring>& springs) : springs_(springs) {}
  void needed_rows(std::vector<PetscInt>&) const override {}
  void bind(const field::RowHalo&) override {}
  void add_residual(std::span<const double> u, std::span<double> r) const override
  {
    for (const Spring& s : springs_) {
      if (s.broken) continue;
      const double force = s.stiffness * s.stretch(u);
      for (std::size_t a = 0; a < 2; ++a) r[static_cast<std::size_t>(2 * s.row) + a] += force * s.along[a];
    }
  }
  double energy(std::span<const double> u) const override
  {
    double sum = 0.0;
    for (const Spring& s : springs_)
      if (!s.broken) sum += 0.5 * s.stiffness * s.stretch(u) * s.stretch(u);
    return sum;
  }
  void couplings(field::Couplings&, bool) const override {}
  void add_jacobian(field::BlockAdder& adder, bool) const override
  {
    for (const Spring& s : springs_) {
      if (s.broken) continue;
      const std::array row{s.row};
      const auto [x, y] = s.along;
      const std::array k{s.stiffness * x * x, s.stiffness * x * y, s.stiffness * x * y, s.stiffness * y * y};
      adder.add(row, row, k);
    }
  }
  void weak_rows(std::vector<Index>& rows) const override
  {
    if (report_weak) rows.insert(rows.end(), weak.begin(), weak.end());
  }
  bool constant_jacobian() const override { return true; }
  /// Which springs are broken, as a number.
  std::int64_t revision() const override
  {
    std::uint64_t state = 0;
    for (const Spring& s : springs_) state = 31 * state + (s.broken ? 2 : 1);
    return static_cast<std::int64_t>(state);
  }

  bool report_weak = false;
  std::vector<Index> weak;

private:
  std::vector<Spring>& springs_;
};

class SpringBreaker final : public field::AfterSolve {
public:
  /// @param at_once springs that may break in one pass on this rank, in the order of the list
  SpringBreaker(std::vector<Spring>& springs, MPI_Comm comm, int at_once = 1 << 30)
      : springs_(springs), comm_(comm), at_once_(at_once), saved_(springs)
  {}
  std::int64_t apply(std::span<const double> u) override
  {
    std::int64_t broken = 0;
    for (Spring& s : springs_)
      if (!s.broken && broken < at_once_ && s.stretch(u) > s.limit) {
        s.broken = true;
        ++broken;
      }
    MPI_Allreduce(MPI_IN_PLACE, &broken, 1, MPI_INT64_T, MPI_SUM, comm_);
    return broken;
  }
  void save() override { saved_ = springs_; }
  void restore() override { springs_ = saved_; }

private:
  std::vector<Spring>& springs_;
  MPI_Comm comm_;
  std::int64_t at_once_;
  std::vector<Spring> saved_;
};

/// Rows on springs and nothing else: `per_rank` rows, force (fx, fy) on each at load 1.
struct SpringBed {
  SpringBed(Index per_rank, std::array<double, 2> force, std::vector<Spring> list) : springs(std::move(list))
  {
    system.rows = field::Rows::number(PETSC_COMM_WORLD, 2, per_rank, 0, 0);
    term = new Springs(springs);
    system.terms.emplace_back(term);
    for (Index row = 0; row < per_rank; ++row) {
      system.load.insert(system.load.end(), force.begin(), force.end());
      system.coordinates.insert(system.coordinates.end(), {1.0 * row, 1.0 * system.rows.first});
    }
    system.bind();
  }
  SpringBed(const SpringBed&) = delete;
  SpringBed& operator=(const SpringBed&) = delete;
  void breakable() { system.after.push_back(std::make_unique<SpringBreaker>(springs, PETSC_COMM_WORLD)); }

  std::vector<Spring> springs;
  field::System system;
  Springs* term = nullptr;
};
} // namespace pdx::test
