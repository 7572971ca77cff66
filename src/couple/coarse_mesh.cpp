#include "pdx/couple/coarse_mesh.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/mesh/locate.hpp"
#include "pdx/mesh/vertex_halo.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pdx::couple {
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

std::vector<PetscInt> vertex_rows(const mesh::Mesh& mesh, const field::Rows& rows)
{
  std::vector<PetscInt> all(static_cast<std::size_t>(mesh.vertices()), -1);
  std::iota(all.begin(), all.begin() + mesh.owned_vertices(), rows.first);
  mesh::fill_halo(mesh, MPIU_INT, 1, all.data());
  return all;
}
} // namespace

CoarseMesh::CoarseMesh(fem::ElasticBody body, const NodeField& node_field, FineRows fine, const field::System& system)
    : body_(body), node_field_(node_field), fine_(std::move(fine)), system_(system)
{
  const mesh::Mesh& mesh = body_.mesh;
  for (Index c = 0; c < mesh.cells(); ++c)
    if (std::ranges::any_of(mesh.cell(c), [&](Index v) { return v < mesh.owned_vertices(); })) cells_.push_back(c);
  if (fine_.breakable) {
    std::vector<Index> covered;
    for (Index c = 0; c < mesh.cells(); ++c) // those that touch an owned vertex and those of owned particles
      if (mesh.use(c) == mesh::Use::covered && (c < mesh.owned_cells() || std::ranges::binary_search(cells_, c)))
        covered.push_back(c);
    support_ = std::make_unique<SupportParts>(mesh, system.rows, fine_.parts, covered);
    for (Index v = 0; v < mesh.vertices(); ++v) local_vertex_.emplace(mesh.natural_vertex(v), v);
  }
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
  extra_vertex_.clear();
  std::vector<SplitRecord> mine;
  if (support_) {
    support_->update();
    mine = split_vertices(extra);
  }
  number(extra, mine);
  sort_cells();
  interpolate();
  hold();
}

/// Splits the owned vertices under patches around which bonds are broken. Rows are counted from the vertices' first
/// ones: 0 .. owned vertices - 1, then the further parts.
std::vector<CoarseMesh::SplitRecord> CoarseMesh::split_vertices(Index& extra)
{
  const mesh::Mesh& mesh = body_.mesh;
  std::vector<SplitRecord> records;
  std::vector<std::vector<Index>> around(static_cast<std::size_t>(mesh.owned_vertices()));
  std::vector<std::uint8_t> touched(around.size(), 0);
  for (const Index c : cells_) {
    if (mesh.use(c) != mesh::Use::covered) continue;
    for (const Index v : mesh.cell(c))
      if (v < mesh.owned_vertices() && fine_.node_rows[static_cast<std::size_t>(v)] < 0) {
        around[static_cast<std::size_t>(v)].push_back(c);
        touched[static_cast<std::size_t>(v)] |= support_->damaged(c);
      }
  }
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    if (!touched[static_cast<std::size_t>(v)]) continue;
    const auto weight = [&](const CellParticle& particle) {
      const auto w = mesh::bilinear_weights(mesh.corners(particle.cell), particle.x);
      for (std::size_t a = 0; a < 4; ++a)
        if (mesh.cell(particle.cell)[a] == v) return w[a];
      return 0.0;
    };
    const std::vector<PartOfVertex> parts = support_->split(around[static_cast<std::size_t>(v)], weight);
    const auto most = std::ranges::max(parts, {}, &PartOfVertex::part).part;
    if (most == 0 && std::ranges::min(parts, {}, &PartOfVertex::part).part == 0) continue;
    for (const PartOfVertex& p : parts) {
      const CellParticle& particle = support_->particles()[p.particle];
      const PetscInt row = p.part <= 0 ? (p.part < 0 ? -1 : v) : mesh.owned_vertices() + extra + p.part - 1;
      records.push_back({mesh.natural_vertex(v), particle.patch, particle.site, row});
    }
    for (int k = 1; k <= most; ++k) extra_vertex_.push_back(v);
    extra += std::max(0, most);
  }
  return records;
}

void CoarseMesh::number(Index extra, std::span<const SplitRecord> mine)
{
  const mesh::Mesh& mesh = body_.mesh;
  rows_ =
      field::Rows::number(mesh.comm(), 2, mesh.owned_vertices() + extra + (fine_.sets ? fine_.sets->owned() : 0), 0, 0);
  first_set_ = mesh.owned_vertices() + extra;
  const std::vector<PetscInt> rows = vertex_rows(mesh, rows_);
  std::vector<PetscInt> needed = rows;
  split_.clear();
  if (support_) {
    std::vector<SplitRecord> records(mine.begin(), mine.end());
    for (SplitRecord& r : records)
      if (r.row >= 0) r.row += rows_.first;
    for (const SplitRecord& r : gather_all(mesh.comm(), records)) {
      const auto found = local_vertex_.find(r.natural_vertex);
      if (found == local_vertex_.end()) continue;
      split_[found->second].push_back({r.patch, r.site, r.row});
      needed.push_back(r.row);
    }
    for (auto& [vertex, leaning] : split_)
      std::ranges::sort(leaning, [](const Leaning& a, const Leaning& b) {
        return std::pair(a.patch, a.site) < std::pair(b.patch, b.site);
      });
  }
  if (fine_.sets) {
    fine_sets_ = gather_all(mesh.comm(), std::vector<PetscInt>{system_.rows.first + system_.rows.nodes});
    coarse_sets_ = gather_all(mesh.comm(), std::vector<PetscInt>{rows_.first + first_set_});
    for (Index v = 0; v < mesh.vertices(); ++v)
      for (const xfem::EnrichedSet& set : fine_.sets->of(v)) {
        const auto rank = std::ranges::upper_bound(fine_sets_, set.row) - fine_sets_.begin() - 1;
        needed.push_back(set.row - fine_sets_[static_cast<std::size_t>(rank)] +
                         coarse_sets_[static_cast<std::size_t>(rank)]);
      }
  }
  halo_ = std::make_unique<field::RowHalo>(rows_, needed);
  local_rows_.clear();
  for (const PetscInt row : rows) local_rows_.push_back(halo_->local(row));
  weak_.clear();
  for (auto& [vertex, leaning] : split_)
    for (Leaning& l : leaning) {
      if (l.row < 0) continue;
      l.row = halo_->local(l.row);
      if (l.row < rows_.owned()) weak_.push_back(l.row);
    }
  std::ranges::sort(weak_);
  weak_.erase(std::unique(weak_.begin(), weak_.end()), weak_.end());
}

/// Coarse row that stands for an enriched set, from its row in the scene: the sets of a rank have the same order in
/// both.
Index CoarseMesh::set_row(PetscInt fine) const
{
  const auto rank = static_cast<std::size_t>(std::ranges::upper_bound(fine_sets_, fine) - fine_sets_.begin() - 1);
  return halo_->local(fine - fine_sets_[rank] + coarse_sets_[rank]);
}

/// What a particle leans on at a vertex.
CoarseMesh::Corner CoarseMesh::corner(Index vertex, int patch, Index site, const Vector<2>& x) const
{
  const auto v = static_cast<std::size_t>(vertex);
  if (fine_.node_rows[v] < 0) {
    const auto split = split_.find(vertex);
    if (split == split_.end()) return {{local_rows_[v], 1.0}};
    const auto at = std::ranges::lower_bound(split->second, std::pair(patch, site), {},
                                             [](const Leaning& l) { return std::pair(l.patch, l.site); });
    if (at == split->second.end() || at->patch != patch || at->site != site || at->row < 0) return {};
    return {{static_cast<Index>(at->row), 1.0}};
  }
  Corner result{{local_rows_[v], 1.0}};
  if (!fine_.sets) return result;
  for (const xfem::EnrichedSet& set : fine_.sets->of(vertex)) {
    if (xfem::side_of(fine_.sets->cracks().side(set.crack, x)) == set.side) continue;
    result.front().factor -= 1.0;
    result.push_back({set_row(set.row), 1.0});
  }
  if (result.front().factor == 0.0) result.erase(result.begin());
  return result;
}

void CoarseMesh::sort_cells()
{
  const mesh::Mesh& mesh = body_.mesh;
  standard_.clear();
  special_.clear();
  fem::ReusedStiffness reused(body_.law);
  std::vector<std::pair<std::array<Corner, 4>, double>> groups; // of particles that lean on the same rows
  for (const Index c : cells_) {
    if (mesh.use(c) == mesh::Use::cut) {
      add_cut(*fine_.sets->cut(c));
      continue;
    }
    const auto& vertices = mesh.cell(c);
    const bool plain = mesh.use(c) == mesh::Use::plain;
    const bool enriched =
        fine_.sets && std::ranges::any_of(vertices, [&](Index v) { return !fine_.sets->of(v).empty(); });
    const bool split = std::ranges::any_of(vertices, [&](Index v) { return split_.contains(v); });
    if (plain || (!enriched && !split && !(support_ && support_->damaged(c)))) {
      standard_.push_back(c);
      continue;
    }
    const auto [first, end] = support_->in_cell(c);
    groups.clear();
    for (std::size_t k = first; k < end; ++k) {
      const CellParticle& p = support_->particles()[k];
      std::array<Corner, 4> corners;
      for (std::size_t a = 0; a < 4; ++a) corners[a] = corner(vertices[a], p.patch, p.site, p.x);
      const auto same = std::ranges::find(groups, corners, &std::pair<std::array<Corner, 4>, double>::first);
      const double share = support_->health(k) / static_cast<double>(end - first);
      if (same == groups.end())
        groups.emplace_back(corners, share);
      else
        same->second += share;
    }
    for (const auto& [corners, share] : groups) add_special(c, corners, share, reused);
  }
}

/// A group of particles counts as its share of the whole element: enough to hold what it holds together, and never
/// singular where few particles would be as points of a quadrature.
void CoarseMesh::add_special(Index cell, const std::array<Corner, 4>& corners, double share,
                             fem::ReusedStiffness& reused)
{
  const fem::ElementMatrix whole = share * reused.of(body_.mesh.corners(cell));
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
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> k = map.transpose() * whole * map;
  special.stiffness.assign(k.data(), k.data() + k.size());
  special_.push_back(std::move(special));
}

/// The cut element's unknowns (u, a) from the coarse rows: a = (v - u) / f where u + f a is the value v across the
/// crack.
void CoarseMesh::add_cut(const xfem::CutElement& cut)
{
  const xfem::EnrichedMatrix k = xfem::enriched_tangent(cut.element, xfem::EnrichedVector::Zero(cut.element.unknowns()),
                                                        body_.law, fem::Kinematics::small);
  Special special;
  for (const Index v : body_.mesh.cell(cut.cell)) special.rows.push_back(local_rows_[static_cast<std::size_t>(v)]);
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(k.rows(), k.cols());
  for (std::size_t a = 0; a < 4; ++a) {
    if (cut.sets[a] < 0) continue;
    const auto at = 2 * static_cast<Eigen::Index>(special.rows.size());
    const double factor = 1.0 / xfem::set_factor(cut, a, xfem::opposite(cut.element.side[a]));
    map.block<2, 2>(at, at) = factor * Eigen::Matrix2d::Identity();
    map.block<2, 2>(at, static_cast<Eigen::Index>(2 * a)) = -factor * Eigen::Matrix2d::Identity();
    special.rows.push_back(set_row(cut.sets[a]));
  }
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> coarse = map.transpose() * k * map;
  special.stiffness.assign(coarse.data(), coarse.data() + coarse.size());
  special_.push_back(std::move(special));
}

void CoarseMesh::interpolate()
{
  const mesh::Mesh& mesh = body_.mesh;
  auto& [offsets, columns, weights] = interpolation_;
  offsets.assign(1, 0);
  columns.clear();
  weights.clear();
  const auto add = [&](Index row, double weight) {
    columns.push_back(row);
    weights.push_back(weight);
  };
  for (const Index v : fine_.nodes) {
    add(local_rows_[static_cast<std::size_t>(v)], 1.0);
    offsets.push_back(columns.size());
  }
  for (Index k = 0; k < system_.rows.enriched; ++k) {
    const Index vertex = fine_.sets->vertices()[static_cast<std::size_t>(k)];
    for (const xfem::EnrichedSet& set : fine_.sets->of(vertex)) {
      if (set.row != system_.rows.first + system_.rows.nodes + k) continue;
      const double factor = 1.0 / xfem::shifted_step(xfem::opposite(set.side), set.side);
      add(first_set_ + k, factor);
      add(local_rows_[static_cast<std::size_t>(vertex)], -factor);
    }
    offsets.push_back(columns.size());
  }
  for (const ParticlePlace& particle : fine_.particles) {
    const auto w = mesh::bilinear_weights(mesh.corners(particle.cell), particle.x);
    for (std::size_t a = 0; a < 4; ++a)
      for (const Share& s : corner(mesh.cell(particle.cell)[a], particle.patch, particle.site, particle.x))
        add(s.row, w[a] * s.factor);
    offsets.push_back(columns.size());
  }
}

void CoarseMesh::hold()
{
  const auto size = static_cast<std::size_t>(halo_->size());
  std::vector<double> sums(size * 3, 0.0); // weight of held x, of held y, of all that leans on a coarse row
  for (const ParticlePlace& particle : fine_.particles) {
    const auto row = static_cast<std::size_t>(particle.row);
    for (std::size_t at = interpolation_.offsets[row]; at < interpolation_.offsets[row + 1]; ++at) {
      double* sum = &sums[3 * static_cast<std::size_t>(interpolation_.columns[at])];
      const double weight = std::abs(interpolation_.weights[at]);
      for (std::size_t a = 0; a < 2; ++a)
        if (system_.held[2 * row + a]) sum[a] += weight;
      sum[2] += weight;
    }
  }
  halo_->reduce(sums, 3);
  std::vector<double> flags(static_cast<std::size_t>(rows_.owned()) * 2, 0.0), all;
  leaning_.assign(flags.size(), 0.0);
  for (std::size_t v = 0; v < static_cast<std::size_t>(rows_.owned()); ++v)
    for (std::size_t a = 0; a < 2; ++a) {
      leaning_[2 * v + a] = sums[3 * v + a];
      flags[2 * v + a] = sums[3 * v + 2] > 0.0 && sums[3 * v + a] >= kHeldShare * sums[3 * v + 2];
    }
  for (std::size_t k = 0; k < fine_.nodes.size() + static_cast<std::size_t>(system_.rows.enriched); ++k) {
    const auto coarse = static_cast<std::size_t>(interpolation_.columns[interpolation_.offsets[k]]); // their own rows
    for (std::size_t a = 0; a < 2; ++a) flags[2 * coarse + a] = system_.held[2 * k + a];
  }
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

MatHandle CoarseMesh::assemble(std::span<const double> u)
{
  static Event event("solve_coarse_assembly");
  Timed timed(event);
  field::Couplings couplings(*halo_);
  fem::count_couplings(body_.mesh, standard_, local_rows_, couplings);
  for (const Special& special : special_)
    for (const Index row : special.rows)
      for (const Index column : special.rows) couplings.add(row, column);
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
  const bool small = body_.kinematics == fem::Kinematics::small;
  field::BlockAdder adder(matrix.get(), *halo_, held_);
  fem::assemble_stiffness(body_, standard_, local_rows_, small ? std::vector<double>{} : node_field_.displacement(u),
                          adder);
  for (const Special& special : special_) adder.add(special.rows, special.rows, special.stiffness);
  add_springs(adder);
  adder.finish(kHeldStiffness * system_.scale);
  PDX_CALL(MatConvert(matrix.get(), MATAIJ, MAT_INPLACE_MATRIX, matrix.address()));
  return matrix;
}

std::vector<double> CoarseMesh::coordinates() const
{
  std::vector<double> x;
  const auto add = [&](Index v) {
    for (Eigen::Index a = 0; a < 2; ++a) x.push_back(body_.mesh.point(v)[a]);
  };
  for (Index v = 0; v < body_.mesh.owned_vertices(); ++v) add(v);
  for (const Index v : extra_vertex_) add(v);
  if (fine_.sets)
    for (const Index v : fine_.sets->vertices()) add(v);
  return x;
}
} // namespace pdx::couple
