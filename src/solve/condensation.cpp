#include "pdx/solve/condensation.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/solve/staged_elimination.hpp"

#include <algorithm>
#include <new>
#include <numeric>

namespace pdx::solve {
namespace {
/// Owned nodes and sets that a Term couples with anything.
void mark_touched(const field::System& system, const field::Term& term, std::vector<std::uint8_t>& touched)
{
  field::Couplings couplings(*system.halo);
  term.couplings(couplings, true);
  for (std::size_t row = 0; row < touched.size(); ++row)
    if (couplings.diagonal[row] > 1 || couplings.off_diagonal[row] > 0) touched[row] = 1;
}

/// Owned nodes and sets that the coarse level of particles leans on.
void mark_leant_on(const field::System& system, std::vector<std::uint8_t>& touched)
{
  const field::CoarseSpace& coarse = *system.coarse;
  const field::Interpolation& p = coarse.interpolation();
  std::vector<double> leant(static_cast<std::size_t>(coarse.halo().size()), 0.0);
  for (std::size_t k = p.offsets[static_cast<std::size_t>(system.rows.first_particle())]; k < p.columns.size(); ++k)
    leant[static_cast<std::size_t>(p.columns[k])] += 1.0;
  coarse.halo().reduce(leant, 1);
  for (std::size_t row = 0; row < touched.size(); ++row) touched[row] |= leant[row] > 0.0;
}

/// A set stays with its node and a node with its sets: on the coarse level the two trade places.
void close(const field::System& system, std::vector<std::uint8_t>& touched)
{
  const field::Interpolation& p = system.coarse->interpolation();
  const auto nodes = static_cast<std::size_t>(system.rows.nodes);
  for (bool again = true; again;) {
    again = false;
    for (std::size_t row = nodes; row < touched.size(); ++row) {
      const std::span group(p.columns.data() + p.offsets[row], p.offsets[row + 1] - p.offsets[row]);
      const auto kept = [&](Index other) { return touched[static_cast<std::size_t>(other)] != 0; };
      if (std::ranges::none_of(group, kept) || std::ranges::all_of(group, kept)) continue;
      for (const Index other : group) touched[static_cast<std::size_t>(other)] = 1;
      again = true;
    }
  }
}

/// K, prescribed components like any other. Collective.
MatHandle stiffness_of_fixed(const field::System& system)
{
  const field::Rows& rows = system.rows;
  field::Couplings couplings(*system.halo);
  for (const auto& term : system.terms)
    if (term->fixed()) term->couplings(couplings, true);
  for (PetscInt& blocks : couplings.diagonal) blocks = std::min(blocks, rows.owned());
  for (PetscInt& blocks : couplings.off_diagonal) blocks = std::min(blocks, rows.total - rows.owned());
  const PetscInt local = rows.dim * rows.owned();
  MatHandle matrix;
  PDX_CALL(MatCreate(rows.comm, matrix.out()));
  PDX_CALL(MatSetSizes(matrix.get(), local, local, PETSC_DETERMINE, PETSC_DETERMINE));
  PDX_CALL(MatSetBlockSize(matrix.get(), rows.dim));
  PDX_CALL(MatSetType(matrix.get(), MATBAIJ)); // blocks assemble several times faster
  PDX_CALL(MatXAIJSetPreallocation(matrix.get(), rows.dim, couplings.diagonal.data(), couplings.off_diagonal.data(),
                                   nullptr, nullptr));
  PDX_CALL(MatSetOption(matrix.get(), MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  const std::vector<std::uint8_t> nothing(system.held.size(), 0);
  field::BlockAdder adder(matrix.get(), *system.halo, nothing);
  for (const auto& term : system.terms)
    if (term->fixed()) term->add_jacobian(adder, true);
  adder.finish(0.0);
  int ranks = 1;
  MPI_Comm_size(rows.comm, &ranks);
  if (ranks > 1) PDX_CALL(MatConvert(matrix.get(), MATAIJ, MAT_INPLACE_MATRIX, matrix.address())); // to be gathered
  return matrix;
}

/// Components of all ranks in order of ranks, by their numbers in the whole System.
std::vector<PetscInt> everywhere(const field::Rows& rows, const std::vector<Index>& mine)
{
  std::vector<PetscInt> global;
  for (const Index component : mine) global.push_back(rows.first * rows.dim + component);
  return gather_all(rows.comm, global);
}

/// Nodes and sets of all ranks by name.
std::vector<NamedRow> named_rows(const field::Rows& rows, std::span<const field::RowName> names)
{
  std::vector<NamedRow> mine;
  for (Index row = 0; row < rows.first_particle(); ++row)
    mine.push_back({names[static_cast<std::size_t>(row)], rows.first + row});
  std::vector<NamedRow> all = gather_all(rows.comm, mine);
  std::ranges::sort(all, {}, [](const NamedRow& row) { return row.name.value(); });
  return all;
}

int rank_of(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

/// How many entries stand before ours.
std::size_t before(MPI_Comm comm, std::size_t mine)
{
  const std::vector<std::size_t> counts = gather_all(comm, std::vector<std::size_t>{mine});
  return std::accumulate(counts.begin(), counts.begin() + rank_of(comm), std::size_t{0});
}
} // namespace

Border border_of(const field::System& system)
{
  Border border;
  std::vector<std::uint8_t> touched(static_cast<std::size_t>(system.rows.first_particle()), 0);
  for (const auto& term : system.terms)
    if (!term->fixed()) mark_touched(system, *term, touched);
  mark_leant_on(system, touched);
  close(system, touched);
  for (std::size_t row = 0; row < touched.size(); ++row)
    if (touched[row]) border.kept.push_back(static_cast<Index>(row));
  std::int64_t counts[2] = {static_cast<std::int64_t>(border.kept.size()), static_cast<std::int64_t>(touched.size())};
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_INT64_T, MPI_SUM, system.rows.comm);
  border.kept_components = system.rows.dim * counts[0];
  border.eliminated_components = system.rows.dim * (counts[1] - counts[0]);
  return border;
}

Condensation::Condensation(const field::System& system, Border border, Lasting* lasting)
    : system_(system), border_(std::move(border))
{
  static Event event("solve_condense");
  const Timed timed(event);
  sort_components();
  const field::Rows& rows = system_.rows;
  const std::vector<PetscInt> held = everywhere(rows, held_);
  const std::vector<double> targets = gather_all(rows.comm, targets_);
  const MatHandle k = stiffness_of_fixed(system_);
  const GatheredMatrix whole(k.get());
  const MatrixRows entries(whole.get());
  ElementsOfLayout elements{entries, rows.dim, {}, everywhere(rows, free_), everywhere(rows, kept_)};
  if (lasting) elements.rows = named_rows(rows, lasting->names);
  std::vector<double> load = gather_all(rows.comm, system_.load);
  std::vector<double> dense;
  int sound = 1;
  if (rank_of(rows.comm) == 0) {
    try { // the others wait: what fails here is told to them
      inner_ = std::make_unique<StagedElimination>(elements, lasting ? &lasting->core : nullptr, dense);
      fault_ = inner_->fault();
      subtract_product(whole.get(), held, targets, load); // what prescribed components pull with at rest of all others
      if (fault_.empty()) load = inner_->condense(load);
    } catch (const std::bad_alloc&) {
      fault_ = "memory does not suffice for what stays of the elements";
    }
    sound = fault_.empty();
  }
  MPI_Bcast(&sound, 1, MPI_INT, 0, rows.comm);
  if (!sound) {
    if (fault_.empty()) fault_ = "the first rank tells why";
    return;
  }
  load_ = ours(load, static_cast<std::size_t>(first_), kept_.size());
  const auto size = static_cast<std::size_t>(size_);
  const std::vector<double> mine = ours(dense, static_cast<std::size_t>(first_) * size, kept_.size() * size);
  stiffness_ = Eigen::Map<const Matrix>(mine.data(), static_cast<Eigen::Index>(kept_.size()), size_);
}

Condensation::~Condensation() = default;

void Condensation::sort_components()
{
  const field::Rows& rows = system_.rows;
  const auto components = static_cast<std::size_t>(rows.dim * rows.first_particle());
  std::vector<double> target(components, 0.0);
  for (std::size_t k = 0; k < system_.prescribed.components.size(); ++k)
    if (const auto c = static_cast<std::size_t>(system_.prescribed.components[k]); c < components)
      target[c] = system_.prescribed.values[k];
  for (std::size_t c = 0; c < components; ++c) {
    if (std::ranges::binary_search(border_.kept, static_cast<Index>(c) / rows.dim)) {
      kept_.push_back(static_cast<Index>(c));
    } else if (system_.held[c]) {
      held_.push_back(static_cast<Index>(c));
      targets_.push_back(target[c]);
    } else
      free_.push_back(static_cast<Index>(c));
  }
  first_ = static_cast<Index>(before(rows.comm, kept_.size()));
  first_free_ = before(rows.comm, free_.size());
  size_ = static_cast<Index>(border_.kept_components);
}

/// A part of what the first rank has.
std::vector<double> Condensation::ours(const std::vector<double>& all, std::size_t first, std::size_t count) const
{
  const MPI_Comm comm = system_.rows.comm;
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) return all;
  const std::vector<int> firsts = gather_all(comm, std::vector<int>{static_cast<int>(first)});
  const std::vector<int> counts = gather_all(comm, std::vector<int>{static_cast<int>(count)});
  std::vector<double> mine(count);
  MPI_Scatterv(all.data(), counts.data(), firsts.data(), MPI_DOUBLE, mine.data(), static_cast<int>(count), MPI_DOUBLE,
               0, comm);
  return mine;
}

void Condensation::recover(double load, std::span<double> u) const
{
  static Event event("solve_recover");
  const Timed timed(event);
  std::vector<double> kept;
  for (const Index c : kept_) kept.push_back(u[static_cast<std::size_t>(c)]);
  kept = gather_all(system_.rows.comm, kept);
  std::vector<double> free;
  if (inner_) free = inner_->answer(load, kept);
  free = ours(free, first_free_, free_.size());
  for (std::size_t k = 0; k < free_.size(); ++k) u[static_cast<std::size_t>(free_[k])] = free[k];
  for (std::size_t k = 0; k < held_.size(); ++k) u[static_cast<std::size_t>(held_[k])] = load * targets_[k];
}
} // namespace pdx::solve
