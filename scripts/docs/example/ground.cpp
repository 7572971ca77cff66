// A row of nodes on an elastic ground: springs from node to node, springs to the ground, a force on the first node. The
// displacement falls off by a factor a node to the next, known in closed form: that of an endless row, where it is
// long.
#include <pdx/field/system.hpp>
#include <pdx/solve/static_driver.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {
constexpr int kNodes = 200;      // of all ranks
constexpr double kLink = 3.0e6;  // from node to node [N/m]
constexpr double kGround = 1e6;  // to the ground [N/m]
constexpr double kForce = 500.0; // on the first node, along x [N]

using pdx::Index;

/// Forces along x and y between a node and the next; each rank counts those whose first node it owns.
class Links final : public pdx::field::Term {
public:
  explicit Links(const pdx::field::Rows& rows) : rows_(rows) {}

  void needed_rows(std::vector<PetscInt>& needed) const override
  {
    if (rows_.first > 0) needed.push_back(rows_.first - 1);
    if (rows_.first + rows_.owned() < rows_.total) needed.push_back(rows_.first + rows_.owned());
  }
  void bind(const pdx::field::RowHalo& halo) override
  {
    const PetscInt first = std::max<PetscInt>(rows_.first - 1, 0);
    const PetscInt last = std::min<PetscInt>(rows_.first + rows_.owned(), rows_.total - 1);
    for (PetscInt row = first; row < last; ++row) pairs_.push_back({halo.local(row), halo.local(row + 1)});
  }
  void add_residual(std::span<const double> u, std::span<double> r) const override
  {
    for (const auto& pair : pairs_)
      for (std::size_t a = 0; a < 2; ++a) {
        const double force = kLink * (u[at(pair[1], a)] - u[at(pair[0], a)]);
        if (pair[0] < rows_.owned()) r[at(pair[0], a)] -= force;
        if (pair[1] < rows_.owned()) r[at(pair[1], a)] += force;
      }
  }
  double energy(std::span<const double> u) const override
  {
    double sum = 0.0;
    for (const auto& pair : pairs_)
      for (std::size_t a = 0; a < 2; ++a)
        if (pair[0] < rows_.owned()) sum += 0.5 * kLink * std::pow(u[at(pair[1], a)] - u[at(pair[0], a)], 2);
    return sum;
  }
  void couplings(pdx::field::Couplings& couplings, bool) const override
  {
    for (const auto& pair : pairs_)
      for (const Index row : pair)
        for (const Index column : pair) couplings.add(row, column);
  }
  void add_jacobian(pdx::field::BlockAdder& adder, bool) const override
  {
    static constexpr std::array<double, 16> block{kLink,  0, -kLink, 0, 0, kLink,  0, -kLink, //
                                                  -kLink, 0, kLink,  0, 0, -kLink, 0, kLink};
    for (const auto& pair : pairs_) adder.add(pair, pair, block);
  }
  bool constant_jacobian() const override { return true; }

private:
  static std::size_t at(Index row, std::size_t a) { return 2 * static_cast<std::size_t>(row) + a; }
  const pdx::field::Rows& rows_;
  std::vector<std::array<Index, 2>> pairs_; // local rows
};

/// The ground under each node: a force against its displacement.
class Ground final : public pdx::field::Term {
public:
  explicit Ground(const pdx::field::Rows& rows) : rows_(rows) {}
  void needed_rows(std::vector<PetscInt>&) const override {} // owned ones alone
  void bind(const pdx::field::RowHalo&) override {}
  void add_residual(std::span<const double> u, std::span<double> r) const override
  {
    for (std::size_t k = 0; k < r.size(); ++k) r[k] += kGround * u[k];
  }
  double energy(std::span<const double> u) const override
  {
    double sum = 0.0;
    for (std::size_t k = 0; k < 2 * static_cast<std::size_t>(rows_.owned()); ++k) sum += 0.5 * kGround * u[k] * u[k];
    return sum;
  }
  void couplings(pdx::field::Couplings& couplings, bool) const override
  {
    for (Index row = 0; row < rows_.owned(); ++row) couplings.add(row, row);
  }
  void add_jacobian(pdx::field::BlockAdder& adder, bool) const override
  {
    static constexpr std::array<double, 4> block{kGround, 0, 0, kGround};
    for (Index row = 0; row < rows_.owned(); ++row) adder.add(std::array{row}, std::array{row}, block);
  }
  bool constant_jacobian() const override { return true; }

private:
  const pdx::field::Rows& rows_;
};

/// True if the first node and what follows it move as they must.
bool solve()
{
  int rank = 0, ranks = 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  pdx::field::System system;
  const int mine = kNodes / ranks + (rank < kNodes % ranks);
  system.rows = pdx::field::Rows::number(PETSC_COMM_WORLD, 2, mine, 0, 0);
  system.terms.push_back(std::make_unique<Links>(system.rows));
  system.terms.push_back(std::make_unique<Ground>(system.rows));
  system.load.assign(2 * static_cast<std::size_t>(mine), 0.0);
  if (rank == 0) system.load[0] = kForce;
  for (int k = 0; k < mine; ++k) {
    system.coordinates.push_back(static_cast<double>(system.rows.first + k));
    system.coordinates.push_back(0.0);
  }
  system.bind();

  pdx::solve::StaticOptions options;
  options.assembled = true; // no coarse grid here: PETSc chooses, or -pc_type
  pdx::solve::StaticDriver driver(system, options);
  const pdx::VecHandle u = system.rows.vector();
  driver.run(u.get(), [](const pdx::solve::Step&, Vec) { return pdx::solve::Verdict::go_on; });

  // Links carry what the nodes behind leave: k (u_i-1 - 2 u_i + u_i+1) = g u_i, so that u falls off by q a node.
  const double half = 1.0 + kGround / (2.0 * kLink), q = half - std::sqrt(half * half - 1.0);
  const double first = kForce / (kGround + kLink * (1.0 - q));
  bool right = true;
  const std::vector<double> values = pdx::field::owned_values(u.get());
  for (int k = 0; k < std::min(mine, 20); ++k) {
    const double expected = first * std::pow(q, static_cast<double>(system.rows.first + k));
    right = right && std::abs(values[2 * static_cast<std::size_t>(k)] - expected) <= 1e-6 * first;
  }
  if (rank == 0) std::printf("the first node moves by %.9g m, expected %.9g m\n", values[0], first);
  MPI_Allreduce(MPI_IN_PLACE, &right, 1, MPI_CXX_BOOL, MPI_LAND, PETSC_COMM_WORLD);
  return right;
}
} // namespace

int main(int argc, char** argv)
{
  if (PetscInitialize(&argc, &argv, nullptr, nullptr)) return EXIT_FAILURE;
  const bool right = solve();
  return PetscFinalize() || !right ? EXIT_FAILURE : EXIT_SUCCESS;
}
