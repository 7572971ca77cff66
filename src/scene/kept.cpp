#include "pdx/scene/kept.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/scene/discretisation.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace pdx::scene {
namespace {
bool same_runs(const geom::SiteSet<2>& a, const geom::SiteSet<2>& b)
{
  if (a.is_box() != b.is_box() || a.lower() != b.lower() || a.upper() != b.upper() || a.size() != b.size())
    return false;
  return a.is_box() || std::ranges::equal(a.runs(), b.runs(), [](const auto& p, const auto& q) {
           return p.first == q.first && p.length == q.length;
         });
}

bool same_names(const geom::SiteNames& a, const geom::SiteNames& b)
{
  return a.first == b.first && a.width == b.width && a.lattice == b.lattice && a.lattices == b.lattices;
}

/// The same sites, counted and called alike, at the same places to the last bit.
bool same_patch(const couple::PatchShape& a, const couple::PatchShape& b)
{
  return a.body == b.body && a.lattice.origin == b.lattice.origin && a.lattice.dx == b.lattice.dx &&
         a.lattice.count == b.lattice.count && same_names(a.names, b.names) && same_runs(a.active, b.active);
}

std::vector<Index> set_vertices(const xfem::EnrichedSets* sets)
{
  return sets ? std::vector<Index>(sets->vertices().begin(), sets->vertices().end()) : std::vector<Index>{};
}

std::span<const pd::Particle> of_patch(std::span<const pd::Particle> all, std::size_t patch)
{
  const auto found = std::ranges::equal_range(all, static_cast<Index>(patch), {}, &pd::Particle::patch);
  return {found.begin(), found.end()};
}

/// Appends the rows of what is in both ascending lists, which are numbered from these rows on.
void add_runs(std::span<const Index> before, PetscInt from, std::span<const Index> after, PetscInt to,
              std::vector<field::RowShift::Run>& runs)
{
  std::size_t a = 0, b = 0;
  while (a < before.size() && b < after.size()) {
    if (before[a] != after[b]) {
      before[a] < after[b] ? ++a : ++b;
      continue;
    }
    const std::size_t first = a;
    while (a < before.size() && b < after.size() && before[a] == after[b]) ++a, ++b;
    const auto length = static_cast<PetscInt>(a - first);
    runs.push_back({from + static_cast<PetscInt>(first), to + static_cast<PetscInt>(b) - length, length});
  }
}
} // namespace

std::vector<Index> near_rows(const Discretisation& scene, const mesh::Mesh& mesh, std::span<const Index> cells)
{
  const field::Rows& rows = scene.system.rows;
  std::vector<Index> near;
  for (const Index v : vertices_of(mesh, cells))
    if (const PetscInt row = scene.node_rows[static_cast<std::size_t>(v)]; v < mesh.owned_vertices() && row >= 0)
      near.push_back(row - rows.first);
  std::ranges::sort(near);
  for (Index row = rows.nodes; row < rows.first_particle(); ++row) near.push_back(row);
  return near;
}

bool Kept::may_stay(const Discretisation& scene, const options::SceneOptions& options)
{
  return options.time.analysis == options::Analysis::explicit_dynamics && options.scheme == couple::Scheme::energy &&
         !scene.point_plan && scene.bonds && scene.carried && scene.seams.empty();
}

std::optional<Kept> Kept::of(Discretisation& scene, const mesh::Mesh& mesh, const options::SceneOptions& options)
{
  if (!may_stay(scene, options)) return std::nullopt;
  Kept kept;
  kept.shapes_ = scene.patch_plan->shapes;
  kept.around_ = std::move(scene.around);
  kept.parts_ = scene.bonds->give_up();
  kept.families_ = scene.carried->give_up();
  kept.particles_ = std::move(scene.particles);
  kept.nodes_ = std::move(scene.nodes);
  kept.sets_ = set_vertices(scene.sets.get());
  PetscInt row = scene.system.rows.first + scene.system.rows.nodes;
  for (const Index v : kept.sets_) {
    const auto of = std::ranges::find(scene.sets->of(v), row++, &xfem::EnrichedSet::row);
    kept.set_names_.push_back(field::RowName::set(mesh.natural_vertex(v), of->crack));
  }
  kept.sets_object_ = std::move(scene.sets);
  kept.node_rows_ = std::move(scene.node_rows);
  kept.coordinates_ = std::move(scene.system.coordinates);
  kept.mass_ = std::move(scene.system.mass);
  kept.inverse_mass_ = std::move(scene.system.inverse_mass);
  for (auto& term : scene.system.terms)
    if (term.get() == scene.elements && scene.elements) {
      (void)term.release();
      kept.elements_.reset(std::exchange(scene.elements, nullptr));
    }
  kept.halo_ = std::move(scene.system.halo);
  return kept;
}

std::vector<bool> Kept::staying(const Discretisation& scene, std::span<const couple::PatchShape> next)
{
  std::vector<bool> stay;
  for (const couple::PatchShape& shape : scene.patch_plan->shapes)
    stay.push_back(std::ranges::any_of(next, [&](const couple::PatchShape& of) { return same_patch(shape, of); }));
  return stay;
}

std::vector<Index> Kept::touched(const Discretisation& scene, const mesh::Mesh& mesh,
                                 std::span<const couple::PatchShape> next)
{
  const std::vector<couple::PatchShape>& now = scene.patch_plan->shapes;
  const std::vector<bool> stay = staying(scene, next);
  TouchedCells cells;
  for (const Index c : mesh.cells(mesh::Use::covered))
    if (!stay[static_cast<std::size_t>(mesh.patch(c))]) cells.note(c, mesh::Use::covered);
  for (const couple::PatchShape& shape : next)
    if (std::ranges::none_of(now, [&](const couple::PatchShape& of) { return same_patch(of, shape); }))
      for (const Index c : cells_under(mesh, shape)) cells.note(c, mesh.use(c));
  return cells.all();
}

void Kept::match(const PatchPlan& next)
{
  from_.assign(next.shapes.size(), -1);
  for (std::size_t p = 0; p < from_.size(); ++p) {
    const auto known =
        std::ranges::find_if(shapes_, [&](const couple::PatchShape& of) { return same_patch(of, next.shapes[p]); });
    if (known != shapes_.end()) from_[p] = static_cast<int>(known - shapes_.begin());
    same_.push_back(known != shapes_.end());
  }
}

void Kept::uncover(mesh::Mesh& mesh)
{
  std::vector<int> to(shapes_.size(), -1);
  for (std::size_t p = 0; p < from_.size(); ++p)
    if (has(p)) to[before(p)] = static_cast<int>(p);
  const std::span<const Index> covered = mesh.cells(mesh::Use::covered);
  for (const Index c : std::vector<Index>(covered.begin(), covered.end()))
    if (const int patch = to[static_cast<std::size_t>(mesh.patch(c))]; patch < 0) {
      note(c, mesh::Use::covered);
      mesh.uncover(c);
    } else
      mesh.cover(c, patch);
}

std::unique_ptr<xfem::EnrichedSets> Kept::sets(mesh::Mesh& mesh, const crack::CrackSet& cracks)
{
  keeps_sets_ = !any_rank(mesh.comm(), near_cracks(mesh, touched_.all(), cracks));
  if (keeps_sets_) {
    sets_object_->look_at(cracks);
    return std::move(sets_object_);
  }
  const std::span<const Index> cut = mesh.cells(mesh::Use::cut);
  for (const Index c : std::vector<Index>(cut.begin(), cut.end())) {
    note(c, mesh::Use::cut);
    mesh.uncover(c);
  }
  return nullptr;
}

std::vector<Index> Kept::nodes(const mesh::Mesh& mesh, std::vector<PetscInt>& rows)
{
  for (const Index c : mesh.cells(mesh::Use::cut))
    if (!keeps_sets_) note(c, mesh::Use::plain); // if nobody else knows of it
  rows = std::move(node_rows_);
  std::vector<Index> gone, come;
  for (const Index v : vertices_of(mesh, touched_.changed(mesh))) {
    if (v >= mesh.owned_vertices()) break;
    PetscInt& row = rows[static_cast<std::size_t>(v)];
    const bool active =
        std::ranges::any_of(mesh.finder().at(v), [&](Index c) { return mesh.use(c) != mesh::Use::covered; });
    if (active != (row >= 0)) (active ? come : gone).push_back(v);
    if (!active) row = -1;
  }
  if (gone.empty() && come.empty()) return nodes_;
  std::vector<Index> kept, all;
  std::ranges::set_difference(nodes_, gone, std::back_inserter(kept));
  std::ranges::set_union(kept, come, std::back_inserter(all));
  return all;
}

std::vector<pd::Particle> Kept::particles(std::span<const pd::Particle> fresh, std::size_t patches)
{
  std::size_t stays = 0, first = 0; // particles, patches that are where they were
  for (; first < patches && has(first) && before(first) == first; ++first) stays += of_patch(particles_, first).size();
  std::vector<pd::Particle> rest;
  for (std::size_t p = first; p < patches; ++p) {
    const auto more = has(p) ? of_patch(particles_, before(p)) : of_patch(fresh, p);
    rest.insert(rest.end(), more.begin(), more.end());
    for (std::size_t k = rest.size() - more.size(); k < rest.size(); ++k) rest[k].patch = static_cast<int>(p);
  }
  std::vector<pd::Particle> all = std::move(particles_);
  all.resize(stays);
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

void Kept::number(const Discretisation& scene, const mesh::Mesh& mesh, Index band)
{
  const field::Rows &rows = scene.system.rows, &old = halo_->rows();
  const bool others = sets_ != set_vertices(scene.sets.get());
  if (any_rank(rows.comm, others)) from_.assign(from_.size(), -1);
  std::vector<PetscInt> moved(shapes_.size(), -1); // first row of each patch before, if it stays
  PetscInt row = rows.first + rows.first_particle();
  for (std::size_t p = 0; p < from_.size(); ++p) {
    if (has(p) && around_[before(p)].band() != band) from_[p] = -1;
    if (has(p)) moved[before(p)] = row;
    row += static_cast<PetscInt>(of_patch(scene.particles, p).size());
  }
  std::vector<field::RowShift::Run> mine;
  add_runs(nodes_, old.first, scene.nodes, rows.first, mine);
  if (!others) mine.push_back({old.first + old.nodes, rows.first + rows.nodes, old.enriched});
  row = old.first + old.first_particle();
  for (std::size_t p = 0; p < shapes_.size(); ++p) {
    const auto length = static_cast<PetscInt>(parts_.parts[p]->sites().size());
    if (moved[p] >= 0) mine.push_back({row, moved[p], length});
    row += length;
  }
  field::StayingRows& stay = handed_.rows;
  stay.before = old.owned();
  stay.now = rows.owned();
  for (const field::RowShift::Run& run : mine)
    stay.runs.push_back(
        {static_cast<Index>(run.from - old.first), static_cast<Index>(run.to - rows.first), run.length});
  for (const Index row_before : stay.leaving())
    if (row_before < old.nodes)
      stay.names.push_back(field::RowName::node(mesh.natural_vertex(nodes_[static_cast<std::size_t>(row_before)])));
    else if (row_before < old.first_particle())
      stay.names.push_back(set_names_[static_cast<std::size_t>(row_before - old.nodes)]);
  for (std::size_t p = 0; p < shapes_.size(); ++p) {
    if (moved[p] >= 0) continue;
    add_names(shapes_[p], parts_.parts[p]->sites(), stay.names);
    const std::vector<std::uint64_t> gone = parts_.parts[p]->gone();
    handed_.gone.insert(handed_.gone.end(), gone.begin(), gone.end());
  }
  shift_ = std::make_shared<field::RowShift>(std::move(halo_), mine);
}

std::vector<double> Kept::coordinates()
{
  rows().carry(coordinates_, 2);
  return std::move(coordinates_);
}

void Kept::give_mass(field::System& next)
{
  rows().carry(mass_, 1);
  rows().carry(inverse_mass_, 1);
  next.mass = std::move(mass_);
  next.inverse_mass = std::move(inverse_mass_);
}

std::vector<std::array<Index, 2>> Kept::near(const Discretisation& next, const mesh::Mesh& mesh) const
{
  const std::vector<Index> coming = rows().coming();
  std::vector<Index> all = near_rows(next, mesh, touched_.all());
  for (const Index row : coming)
    if (row >= next.system.rows.first_particle()) all.push_back(row);
  return ranges_of(all);
}

std::unique_ptr<fem::ElasticTerm> Kept::elements(const mesh::Mesh& mesh, std::span<const PetscInt> node_rows)
{
  if (elements_) elements_->change(touched_.changed(mesh), {node_rows.begin(), node_rows.end()});
  return std::move(elements_);
}

std::unique_ptr<pd::LatticePart<2>> Kept::part(std::size_t patch, pd::BondTerm<2>::Laid& laid)
{
  if (!has(patch)) return nullptr;
  laid = std::move(parts_.laid[before(patch)]);
  return std::move(parts_.parts[before(patch)]);
}

std::vector<std::optional<couple::Surroundings>> Kept::around()
{
  std::vector<std::optional<couple::Surroundings>> known(from_.size());
  for (std::size_t p = 0; p < known.size(); ++p) {
    if (!has(p)) continue;
    known[p] = std::move(around_[before(p)]);
    known[p]->move_rows(*shift_);
  }
  return known;
}

couple::KeptFamilies Kept::families()
{
  couple::KeptFamilies kept;
  kept.families.resize(from_.size());
  for (std::size_t p = 0; p < from_.size(); ++p)
    if (has(p)) kept.families[p] = std::move(families_[before(p)]);
  kept.shift = shift_;
  return kept;
}
} // namespace pdx::scene
