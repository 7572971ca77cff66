#include "pdx/coarse/coarse_mesh.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/xfem/enriched_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::coarse {
namespace {
/// A coarse component is held when prescribed particles have at least this share of the weight that leans on it: a
/// layer of a horizon holds the nodes at its inner border, which lean on it by half.
constexpr double kHeldShare = 0.3;
/// Held coarse components take no correction: their diagonal is this much above the others.
constexpr double kHeldStiffness = 1e8;
/// Held particles too few to hold a coarse component are springs on it, each this stiff: without them a body that only
/// such particles hold would leave the coarse level singular.
constexpr double kSpringStiffness = 1.0;
/// A part that came off has no stiffness against rigid motion: the coarse level needs some.
constexpr double kFloatingStiffness = 1e-6;

fem::Corners rectangle(const Vector<2>& size)
{
  return {Vector<2>(0.0, 0.0), Vector<2>(size[0], 0.0), size, Vector<2>(0.0, size[1])};
}

/// Stiffness of the unknowns that `map` takes to those of k, row by row.
std::vector<double> congruent(const Eigen::MatrixXd& map, const Eigen::Ref<const Eigen::MatrixXd>& k)
{
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> result = map.transpose() * k * map;
  return {result.data(), result.data() + result.size()};
}
} // namespace

CoarseMesh::CoarseMesh(fem::ElasticBody body, const couple::NodeField& node_field, const FineRows& fine,
                       const field::System& system)
    : body_(body), node_field_(node_field), fine_(fine), system_(system)
{
  const mesh::Mesh& mesh = body_.mesh;
  const auto touches = [&](Index c) {
    return std::ranges::any_of(mesh.cell(c), [&](Index v) { return v < mesh.owned_vertices(); });
  };
  std::ranges::copy_if(mesh.cells(mesh::Use::plain), std::back_inserter(elements_), touches);
  std::ranges::copy_if(mesh.cells(mesh::Use::cut), std::back_inserter(cut_), touches);
  for (std::size_t p = 0; p < fine_.parts.size(); ++p) {
    grids_.emplace_back(*fine_.parts[p], fine_.around[p]);
    first_kind_.push_back(grid_stiffness_.size());
    for (std::size_t kind = 0; kind < grids_[p].kinds(); ++kind)
      for (std::size_t law = 0; law < body_.laws(); ++law)
        grid_stiffness_.push_back(fem::element_tangent(rectangle(grids_[p].size_of(kind)), fem::ElementVector::Zero(),
                                                       body_.regions ? body_.regions->elastic(law) : body_.law,
                                                       law::Kinematics::small));
  }
  fine_first_ = gather_all(mesh.comm(), std::vector<PetscInt>{system.rows.first});
  gather_sets();
  choose_cells();
  lay_out();
}

bool CoarseMesh::rebuild()
{
  if (!support_) return false;
  lay_out();
  return true;
}

void CoarseMesh::lay_out()
{
  static Event event("solve_coarse_layout");
  Timed timed(event);
  Index extra = 0;
  extra_points_.clear();
  std::vector<SplitRecord> mine;
  if (support_) {
    support_->update();
    mine = split_nodes(extra);
  }
  number(extra, std::move(mine));
  sort_cells();
  interpolate();
  hold();
}

void CoarseMesh::sort_cells()
{
  intact_.clear();
  special_.clear();
  for (const Index c : cut_)
    for (const xfem::CutElement& cut : fine_.sets->all_of(c)) add_cut(cut);
  cut_elements_ = special_.size();
  std::vector<std::pair<std::array<Corner, 4>, double>> groups; // of particles that lean on the same rows
  for (std::size_t number = 0; number < cells_.size(); ++number) {
    const auto& [patch, cell, assembled] = cells_[number];
    if (!assembled) continue;
    const auto p = static_cast<std::size_t>(patch);
    const auto nodes = grids_[p].corners(cell);
    const bool carried = std::ranges::any_of(nodes, [&](Index node) { return grids_[p].carried(node); });
    const bool split = std::ranges::any_of(nodes, [&, key = patch](Index node) {
      return split_.contains({key, node});
    });
    const Vector<2> middle = 0.5 * (grids_[p].point(nodes[0]) + grids_[p].point(nodes[2]));
    const std::size_t stiffness =
        first_kind_[p] + grids_[p].kind(cell) * body_.laws() + (body_.regions ? body_.regions->at(middle) : 0);
    const bool damaged = support_ && support_->damaged(static_cast<Index>(number));
    groups.clear();
    if (!carried && !split && !damaged) {
      std::array<Index, 4> rows;
      for (std::size_t a = 0; a < 4; ++a) rows[a] = grid_rows_[p][static_cast<std::size_t>(nodes[a])];
      intact_.emplace_back(stiffness, rows);
    } else if (!split && !damaged && sets_.empty()) {
      groups.emplace_back();
      for (std::size_t a = 0; a < 4; ++a) groups.back().first[a] = corner(patch, nodes[a], -1, middle);
      groups.back().second = 1.0;
    } else {
      const auto [first, end] = support_->in_cell(static_cast<Index>(number));
      for (std::size_t k = first; k < end; ++k) {
        const couple::CellParticle& particle = support_->particles()[k];
        std::array<Corner, 4> corners;
        for (std::size_t a = 0; a < 4; ++a) corners[a] = corner(patch, nodes[a], particle.site, particle.x);
        const auto same = std::ranges::find(groups, corners, &std::pair<std::array<Corner, 4>, double>::first);
        const double share = support_->health(k) / static_cast<double>(end - first);
        if (same == groups.end())
          groups.emplace_back(corners, share);
        else
          same->second += share;
      }
    }
    for (const auto& [corners, share] : groups) add_special(share * grid_stiffness_[stiffness], corners);
  }
}

/// A group of particles counts as its share of the whole cell: enough to hold what it holds together, and never
/// singular where few particles would be as points of a quadrature.
void CoarseMesh::add_special(const fem::ElementMatrix& stiffness, const std::array<Corner, 4>& corners)
{
  Special special;
  for (const Corner& corner : corners)
    for (const Share& s : corner)
      if (std::ranges::find(special.rows, s.row) == special.rows.end()) special.rows.push_back(s.row);
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(8, 2 * static_cast<Eigen::Index>(special.rows.size()));
  for (std::size_t a = 0; a < 4; ++a)
    for (const Share& s : corners[a]) {
      const auto column = std::ranges::find(special.rows, s.row) - special.rows.begin();
      map.block<2, 2>(static_cast<Eigen::Index>(2 * a), 2 * column) += s.factor * Eigen::Matrix2d::Identity();
    }
  special.stiffness = congruent(map, stiffness);
  special_.push_back(std::move(special));
}

/// The cut element's unknowns (u, a) from the coarse rows: a = (v - u) / f where u + f a is the value v across the
/// crack.
void CoarseMesh::add_cut(const xfem::CutElement& cut)
{
  const xfem::EnrichedMatrix k = xfem::enriched_tangent(cut.element, xfem::EnrichedVector::Zero(cut.element.unknowns()),
                                                        body_.law_of(cut.cell), law::Kinematics::small);
  Special special;
  for (const Index v : body_.mesh.cell(cut.cell)) special.rows.push_back(vertex_rows_[static_cast<std::size_t>(v)]);
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(k.rows(), k.cols());
  for (std::size_t a = 0; a < 4; ++a) {
    if (cut.sets[a] < 0) continue;
    const auto at = 2 * static_cast<Eigen::Index>(special.rows.size());
    const double factor = 1.0 / sets_.at(cut.sets[a]).factor;
    map.block<2, 2>(at, at) = factor * Eigen::Matrix2d::Identity();
    map.block<2, 2>(at, static_cast<Eigen::Index>(2 * a)) = -factor * Eigen::Matrix2d::Identity();
    special.rows.push_back(halo_->local(coarse_of(cut.sets[a])));
  }
  special.stiffness = congruent(map, k);
  special_.push_back(std::move(special));
}

void CoarseMesh::interpolate()
{
  std::vector<std::size_t>& offsets = interpolation_.offsets;
  std::vector<Index>& columns = interpolation_.columns;
  std::vector<double>& weights = interpolation_.weights;
  offsets.assign(1, 0);
  columns.clear();
  weights.clear();
  const auto add = [&](Index row, double weight) {
    columns.push_back(row);
    weights.push_back(weight);
  };
  for (Index k = 0; k < system_.rows.nodes; ++k) {
    add(k, 1.0);
    offsets.push_back(columns.size());
  }
  for (Index k = system_.rows.nodes; k < system_.rows.first_particle(); ++k) {
    const SetRecord& record = sets_.at(system_.rows.first + k);
    add(k, 1.0 / record.factor);
    add(static_cast<Index>(record.node - system_.rows.first), -1.0 / record.factor);
    offsets.push_back(columns.size());
  }
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    const auto& lattice = grids_[p].part().lattice();
    for (const Index number : grids_[p].part().sites()) {
      const Site<2> site = grids_[p].part().site(number);
      const Vector<2> x = lattice.point(site);
      const Index cell = grids_[p].cell_of(site);
      const auto nodes = grids_[p].corners(cell);
      const auto w = grids_[p].weights(cell, x);
      for (std::size_t a = 0; a < 4; ++a)
        for (const Share& s : corner(static_cast<int>(p), nodes[a], number, x)) add(s.row, w[a] * s.factor);
      offsets.push_back(columns.size());
    }
  }
}

void CoarseMesh::hold()
{
  const auto size = static_cast<std::size_t>(halo_->size());
  const auto first_particle = static_cast<std::size_t>(system_.rows.first_particle());
  std::vector<double> sums(size * 3, 0.0); // weight of held x, of held y, of all that leans on a coarse row
  for (std::size_t row = first_particle; row < static_cast<std::size_t>(system_.rows.owned()); ++row)
    for (std::size_t at = interpolation_.offsets[row]; at < interpolation_.offsets[row + 1]; ++at) {
      double* sum = &sums[3 * static_cast<std::size_t>(interpolation_.columns[at])];
      const double weight = std::abs(interpolation_.weights[at]);
      for (std::size_t a = 0; a < 2; ++a)
        if (system_.held[2 * row + a]) sum[a] += weight;
      sum[2] += weight;
    }
  halo_->reduce(sums, 3);
  std::vector<double> flags(static_cast<std::size_t>(rows_.owned()) * 2, 0.0), all;
  leaning_.assign(flags.size(), 0.0);
  for (std::size_t v = 0; v < static_cast<std::size_t>(rows_.owned()); ++v)
    for (std::size_t a = 0; a < 2; ++a) {
      leaning_[2 * v + a] = sums[3 * v + a];
      flags[2 * v + a] = sums[3 * v + 2] > 0.0 && sums[3 * v + a] >= kHeldShare * sums[3 * v + 2];
    }
  for (std::size_t k = 0; k < 2 * first_particle; ++k) flags[k] = system_.held[k]; // nodes and sets: their own rows
  halo_->fetch(flags, 2, all);
  held_.assign(all.begin(), all.end());
}

void CoarseMesh::add_springs(field::BlockAdder& adder) const
{
  for (Index row = 0; row < rows_.owned(); ++row) {
    const double* weight = &leaning_[2 * static_cast<std::size_t>(row)];
    const std::array values{kSpringStiffness * system_.scale * weight[0], 0.0, 0.0,
                            kSpringStiffness * system_.scale * weight[1]};
    if (weight[0] > 0.0 || weight[1] > 0.0) adder.add(std::span(&row, 1), std::span(&row, 1), values);
  }
  const double tiny = kFloatingStiffness * system_.scale;
  for (const Index row : weak_) adder.add(std::span(&row, 1), std::span(&row, 1), std::array{tiny, 0.0, 0.0, tiny});
}

MatHandle CoarseMesh::assembled(std::span<const double> u, bool elements) const
{
  static Event event("solve_coarse_assembly");
  Timed timed(event);
  field::Couplings couplings(*halo_);
  if (elements) fem::count_couplings(body_.mesh, elements_, vertex_rows_, couplings);
  const auto specials = std::span(special_).subspan(elements ? 0 : cut_elements_);
  const auto couple_all = [&](std::span<const Index> rows) {
    for (const Index row : rows)
      for (const Index column : rows) couplings.add(row, column);
  };
  for (const auto& [stiffness, rows] : intact_) couple_all(rows);
  for (const Special& special : specials) couple_all(special.rows);
  for (PetscInt& blocks : couplings.diagonal) blocks = std::min(blocks, rows_.owned());
  for (PetscInt& blocks : couplings.off_diagonal) blocks = std::min(blocks, rows_.total - rows_.owned());
  MatHandle matrix;
  PDX_CALL(MatCreate(rows_.comm, matrix.out()));
  PDX_CALL(MatSetSizes(matrix.get(), 2 * rows_.owned(), 2 * rows_.owned(), PETSC_DETERMINE, PETSC_DETERMINE));
  PDX_CALL(MatSetBlockSize(matrix.get(), 2));
  PDX_CALL(MatSetType(matrix.get(), MATBAIJ)); // blocks assemble several times faster; multigrid wants plain rows
  PDX_CALL(MatXAIJSetPreallocation(matrix.get(), 2, couplings.diagonal.data(), couplings.off_diagonal.data(), nullptr,
                                   nullptr));
  PDX_CALL(MatSetOption(matrix.get(), MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  const bool small = body_.kinematics == law::Kinematics::small;
  field::BlockAdder adder(matrix.get(), *halo_, held_);
  if (elements)
    fem::assemble_stiffness(body_, elements_, vertex_rows_, small ? std::vector<double>{} : node_field_.displacement(u),
                            adder);
  for (const auto& [stiffness, rows] : intact_) adder.add(rows, rows, std::span(grid_stiffness_[stiffness].data(), 64));
  for (const Special& special : specials) adder.add(special.rows, special.rows, special.stiffness);
  add_springs(adder);
  adder.finish(kHeldStiffness * system_.scale);
  PDX_CALL(MatConvert(matrix.get(), MATAIJ, MAT_INPLACE_MATRIX, matrix.address()));
  return matrix;
}

} // namespace pdx::coarse
