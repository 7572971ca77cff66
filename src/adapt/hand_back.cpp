#include "pdx/adapt/hand_back.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/base/symmetric.hpp"
#include "pdx/geom/box_cover.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace pdx::adapt {
namespace {
constexpr double kSays = 1e-6; // of the largest eigenvalue: what the particles say no more of than that stays at rest

/// A term of the equations of all fresh rows: row and column by global row, or the right side of one.
struct Entry {
  PetscInt row, column; // column < 0: right side -1 - column
  double value;
};

Vector<2> pair_at(std::span<const double> field, std::size_t k) { return {field[2 * k], field[2 * k + 1]}; }

/// What a particle says of the fresh rows of the element that takes its place.
class SetEquations {
public:
  SetEquations(const SceneView& scene, const Leaving& left, std::span<const Index> is_new,
               std::span<const std::span<double>> fields)
      : scene_(scene), left_(left)
  {
    const field::Rows& rows = scene.halo.rows();
    const auto owned = static_cast<std::size_t>(rows.owned());
    std::vector<double> fresh(owned, 0.0);
    for (const Index row : is_new) fresh[static_cast<std::size_t>(row)] = 1.0;
    scene.halo.fetch(fresh, 1, is_asked_);
    std::vector<double> loose(owned, 0.0); // of cut elements, and the only row of their node there
    if (scene.sets) note_loose_nodes(*scene.sets, loose);
    std::fill_n(loose.begin() + rows.nodes, rows.enriched, 1.0);
    std::vector<double> of_cracks;
    scene.halo.fetch(loose, 1, of_cracks);
    for (std::size_t k = 0; k < is_asked_.size(); ++k) is_asked_[k] *= of_cracks[k];
    for (const std::span<double> field : fields) scene.halo.fetch(field, 2, fields_.emplace_back());
  }

  void add(std::size_t particle)
  {
    const couple::Host host = couple::host_in_cell({scene_.mesh, scene_.node_rows, scene_.sets}, left_.cells[particle],
                                                   left_.places[particle]);
    const auto rows = static_cast<std::size_t>(host.count);
    for (std::size_t a = 0; a < rows; ++a) {
      if (!is_asked(host.rows[a])) continue;
      for (std::size_t b = 0; b < rows; ++b)
        if (is_asked(host.rows[b])) matrix_[{host.rows[a], host.rows[b]}] += host.weights[a] * host.weights[b];
      for (std::size_t f = 0; f < fields_.size(); ++f) {
        Vector<2> missing = pair_at(left_.fields[f], particle);
        for (std::size_t b = 0; b < rows; ++b) missing -= host.weights[b] * pair_at(fields_[f], local(host.rows[b]));
        for (int d = 0; d < 2; ++d)
          matrix_[{host.rows[a], -1 - static_cast<PetscInt>(2 * f) - d}] += host.weights[a] * missing[d];
      }
    }
  }

  std::vector<Entry> entries() const
  {
    std::vector<Entry> all;
    for (const auto& [place, value] : matrix_) all.push_back({place.first, place.second, value});
    return all;
  }

private:
  void note_loose_nodes(const xfem::EnrichedSets& sets, std::span<double> loose) const
  {
    const field::Rows& rows = scene_.halo.rows();
    for (const xfem::CutElement& cut : sets.cells())
      for (std::size_t a = 0; a < 4; ++a) {
        const Index vertex = scene_.mesh.cell(cut.cell)[a];
        const PetscInt row = scene_.node_rows[static_cast<std::size_t>(vertex)] - rows.first;
        const bool has_none = cut.piece ? sets.of(vertex).empty() : cut.sets[a] < 0;
        if (has_none && row >= 0 && row < rows.nodes) loose[static_cast<std::size_t>(row)] = 1.0;
      }
  }

  std::size_t local(PetscInt row) const { return static_cast<std::size_t>(scene_.halo.local(row)); }
  bool is_asked(PetscInt row) const { return is_asked_[local(row)] > 0.0; }

  const SceneView& scene_;
  const Leaving& left_;
  std::vector<double> is_asked_; // per local row
  std::vector<std::vector<double>> fields_;
  std::map<std::pair<PetscInt, PetscInt>, double> matrix_;
};

/// The equations of all ranks.
class Together {
public:
  Together(const std::vector<Entry>& entries, std::size_t sides)
  {
    for (const Entry& entry : entries)
      if (entry.column < 0) number_.try_emplace(entry.row, 0);
    Eigen::Index count = 0;
    for (auto& [row, number] : number_) number = count++;
    matrix_ = Eigen::MatrixXd::Zero(count, count);
    right_ = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(sides));
    for (const auto& [row, column, value] : entries)
      (column < 0 ? right_(number_.at(row), -1 - column) : matrix_(number_.at(row), number_.at(column))) += value;
  }

  /// The least values that satisfy them, by global row.
  std::map<PetscInt, Eigen::RowVectorXd> solve() const
  {
    std::map<PetscInt, Eigen::RowVectorXd> values;
    if (number_.empty()) return values;
    const Eigen::MatrixXd all = least_solution(matrix_, right_, kSays);
    for (const auto& [row, number] : number_) values[row] = all.row(number);
    return values;
  }

private:
  std::map<PetscInt, Eigen::Index> number_;
  Eigen::MatrixXd matrix_, right_;
};
} // namespace

Leaving leaving(const SceneView& scene, std::span<const geom::Box<2>> uncovered,
                std::span<const std::span<const double>> fields)
{
  Leaving left;
  left.fields.resize(fields.size());
  if (uncovered.empty()) return left;
  const auto first = static_cast<std::size_t>(scene.halo.rows().first_particle());
  for_each_particle_near(scene, uncovered, [&](std::size_t k) {
    const pd::Particle& p = scene.particles[k];
    if (!geom::hold(uncovered, p.x)) return;
    left.cells.push_back(p.cell);
    left.places.push_back(p.x);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const Vector<2> value = pair_at(fields[f], first + k);
      left.fields[f].insert(left.fields[f].end(), {value[0], value[1]});
    }
  });
  return left;
}

FreshRows fresh_sets(const SceneView& scene, const LayoutChange& change, std::size_t fields)
{
  FreshRows fresh;
  const mesh::Mesh& mesh = scene.mesh;
  const int now = scene.sets ? scene.sets->cracks().size() : 0;
  const int cracks = change.cracks ? static_cast<int>(change.cracks->size()) : now;
  std::set<Index> beside; // vertices of cut elements: what changes around them may part their support
  for (const Index c : mesh.cells(mesh::Use::cut))
    for (const Index v : mesh.cell(c)) beside.insert(v);
  std::set<Index> asked = beside;
  for (const Index c : mesh.finder().around(change.uncover))
    for (const Index v : mesh.cell(c))
      if (geom::hold(change.uncover, mesh.point(v))) asked.insert(v);
  for (const Index v : asked) {
    if (v >= mesh.owned_vertices()) break;
    const std::span<const xfem::EnrichedSet> known =
        scene.sets ? scene.sets->of(v) : std::span<const xfem::EnrichedSet>();
    for (int crack = 0; crack < std::max(cracks, scene.sets ? scene.sets->codes() : 0); ++crack)
      if (std::ranges::find(known, crack, &xfem::EnrichedSet::crack) == known.end())
        fresh.names.push_back(field::RowName::set(mesh.natural_vertex(v), crack));
  }
  fresh.fields.assign(fields, std::vector<double>(2 * fresh.names.size(), 0.0));
  return fresh;
}

void fit_sets(const SceneView& scene, const Leaving& left, std::span<const Index> is_new,
              std::span<const std::span<double>> fields)
{
  const bool any = scene.sets && (scene.halo.rows().enriched > 0 || !scene.sets->cells().empty());
  if (!any_rank(scene.mesh.comm(), any)) return;
  SetEquations equations(scene, left, is_new, fields);
  for (std::size_t k = 0; k < left.cells.size(); ++k) equations.add(k);
  const Together together(gather_all(scene.mesh.comm(), equations.entries()), 2 * fields.size());
  const field::Rows& rows = scene.halo.rows();
  for (const auto& [row, values] : together.solve()) {
    if (!rows.owns(row)) continue;
    const auto k = static_cast<std::size_t>(row - rows.first);
    for (std::size_t f = 0; f < fields.size(); ++f)
      for (std::size_t d = 0; d < 2; ++d) fields[f][2 * k + d] += values[static_cast<Eigen::Index>(2 * f + d)];
  }
}
} // namespace pdx::adapt
