#include "pdx/base/gather.hpp"
#include "pdx/couple/surroundings.hpp"
#include "pdx/mesh/locate.hpp"
#include "pdx/mesh/sites.hpp"

#include <algorithm>
#include <unordered_map>

// How Surroundings come about: each rank looks at its own cells, then all know all.
namespace pdx::couple {
Host host_in_cell(const ElementView& scene, Index cell, const Vector<2>& x)
{
  const auto weights = mesh::bilinear_weights(scene.mesh.corners(cell), x);
  const bool is_cut = scene.sets && scene.sets->cut(cell);
  const auto [cut, side] = is_cut ? scene.sets->at(cell, x) : std::pair{nullptr, xfem::Side::plus};
  static_assert(Host::kRows >= 8); // four nodes and a set of each: there is room
  Host host;
  host.across = cut && !cut->piece && side != xfem::side_of(scene.sets->cracks().side(cut->crack, x));
  for (std::size_t a = 0; a < 4; ++a) {
    const PetscInt node = scene.node_rows[static_cast<std::size_t>(scene.mesh.cell(cell)[a])];
    (void)host.add(node, weights[a]);
    if (!cut) continue;
    const double factor = xfem::set_factor(*cut, a, side);
    if (factor != 0.0) (void)host.cross(node, cut->sets[a], weights[a], factor);
  }
  return host;
}

std::vector<Surroundings::OutsideSite>
Surroundings::find_outside(const ElementView& scene, std::span<const Surroundings> patches, std::vector<Host>* hosts)
{
  std::vector<OutsideSite> found;
  const mesh::Mesh& mesh = scene.mesh;
  std::vector<geom::SiteSet<2>> near;
  std::vector<geom::Box<2>> bounds; // of all sites that are looked at
  for (const Surroundings& patch : patches) {
    const geom::Lattice<2>& lattice = patch.shape_.lattice;
    if (patch.known_) { // nothing is looked at
      near.emplace_back();
      bounds.emplace_back();
      continue;
    }
    near.push_back(patch.shape_.active.grown(patch.band_));
    const Site<2>&lower = near.back().lower(), &upper = near.back().upper();
    bounds.push_back({lattice.point({lower[0] - 1, lower[1] - 1}), lattice.point(upper)});
  }
  std::vector<geom::Box<2>> looked_at;
  for (std::size_t p = 0; p < patches.size(); ++p)
    if (!patches[p].known_) looked_at.push_back(bounds[p]);
  for (const Index c : mesh.finder().around(looked_at)) {
    if (c >= mesh.owned_cells()) break;
    const auto corners = mesh.corners(c);
    const Vector<2> lower = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]).cwiseMin(corners[3]);
    const Vector<2> upper = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]).cwiseMax(corners[3]);
    for (std::size_t p = 0; p < patches.size(); ++p) {
      const PatchShape& shape = patches[p].shape_;
      if (patches[p].known_ || mesh.patch(c) == static_cast<int>(p) || mesh.body(c) != shape.body) continue;
      if ((lower.array() > bounds[p].upper.array()).any() || (upper.array() < bounds[p].lower.array()).any()) continue;
      mesh::for_each_site(mesh, c, shape.lattice, patches[p].band_, [&](const Site<2>& site, const Vector<2>& x) {
        if (shape.active.has(site) || !near[p].has(site)) return;
        found.push_back({static_cast<int>(p), site});
        if (hosts) hosts->push_back(mesh.use(c) == mesh::Use::covered ? Host() : host_in_cell(scene, c, x));
      });
    }
  }
  return found;
}

Surroundings::Edge Surroundings::edge_of(const ElementView& scene, Index behind, std::array<Index, 2> vertices,
                                         Eigen::Index along)
{
  const mesh::Mesh& mesh = scene.mesh;
  if (mesh.point(vertices[0])[along] > mesh.point(vertices[1])[along]) std::swap(vertices[0], vertices[1]);
  Edge edge{};
  edge.begin = mesh.point(vertices[0])[along];
  edge.end = mesh.point(vertices[1])[along];
  edge.crack = -1;
  const xfem::CutElement* cut = scene.sets ? scene.sets->cut(behind) : nullptr;
  if (cut) {
    edge.crack = cut->crack;
    edge.snapped = cut->snapped ? (*cut->snapped == xfem::Side::plus ? 1 : -1) : 0;
  }
  for (std::size_t end = 0; end < 2; ++end) {
    edge.rows[end] = scene.node_rows[static_cast<std::size_t>(vertices[end])];
    edge.sets[end] = -1;
    for (std::size_t a = 0; cut && a < 4; ++a)
      if (mesh.cell(behind)[a] == vertices[end]) {
        edge.node_side[end] = xfem::side_of(cut->distance[a]);
        for (const xfem::CutElement& piece : scene.sets->all_of(behind)) // one at most has it; no node of a junction
          if (piece.sets[a] >= 0) edge.sets[end] = piece.sets[a];
      }
  }
  return edge;
}

void Surroundings::find_edges(const ElementView& scene, std::span<const Surroundings> patches,
                              std::vector<EdgeRecord>& found)
{
  const mesh::Mesh& mesh = scene.mesh;
  const auto key = [](Index a, Index b) {
    return static_cast<std::int64_t>(std::min(a, b)) << 32 | static_cast<std::int64_t>(std::max(a, b));
  };
  std::unordered_map<std::int64_t, Index> behind; // edge -> element on the other side, -1 for none
  std::vector<Index> covered;                     // by patches that are new
  for (const Index c : mesh.cells(mesh::Use::covered))
    if (!patches[static_cast<std::size_t>(mesh.patch(c))].known_) covered.push_back(c);
  std::vector<Index> corners;
  for (const Index c : covered)
    for (std::size_t a = 0; a < 4; ++a) {
      behind[key(mesh.cell(c)[a], mesh.cell(c)[(a + 1) % 4])] = -1;
      corners.push_back(mesh.cell(c)[a]);
    }
  for (const Index c : mesh.finder().at_any(corners))
    for (std::size_t a = 0; a < 4 && mesh.use(c) != mesh::Use::covered; ++a)
      if (const auto edge = behind.find(key(mesh.cell(c)[a], mesh.cell(c)[(a + 1) % 4])); edge != behind.end())
        edge->second = c;
  for (const Index c : covered) {
    if (c >= mesh.owned_cells()) continue;
    for (std::size_t a = 0; a < 4; ++a) {
      const Index v = mesh.cell(c)[a], w = mesh.cell(c)[(a + 1) % 4], element = behind.at(key(v, w));
      if (element < 0) continue;
      const auto p = static_cast<std::size_t>(mesh.patch(c));
      const int side = patches[p].side_of(mesh.point(v), mesh.point(w));
      if (side < 0) continue;
      const auto axis = static_cast<Eigen::Index>(patches[p].sides_[static_cast<std::size_t>(side)].line.axis);
      found.push_back({static_cast<int>(p), side, edge_of(scene, element, {v, w}, 1 - axis)});
    }
  }
}

std::vector<Surroundings> Surroundings::survey(const mesh::Mesh& mesh, std::span<const PatchShape> patches, Index band,
                                               std::span<const PetscInt> node_rows, const xfem::EnrichedSets* sets,
                                               const crack::CrackSet* seams, bool hosts,
                                               std::vector<std::optional<Surroundings>> known)
{
  std::vector<Surroundings> all;
  all.reserve(patches.size());
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const bool is_known = p < known.size() && known[p];
    all.push_back(is_known ? std::move(*known[p]) : Surroundings(patches[p], band));
    all.back().known_ = is_known;
  }
  for (Surroundings& around : all) {
    around.cracks_ = sets ? &sets->cracks() : nullptr;
    around.seams_ = seams;
  }
  std::vector<EdgeRecord> edges;
  const ElementView scene{mesh, node_rows, sets};
  std::vector<Host> holders;
  std::vector<OutsideSite> outside = find_outside(scene, all, hosts ? &holders : nullptr);
  outside = gather_all(mesh.comm(), outside);
  holders = gather_all(mesh.comm(), holders);
  find_edges(scene, all, edges);
  for (Surroundings& around : all)
    if (!around.known_) around.hosts_.resize(hosts ? 0 : 1);
  for (std::size_t k = 0; k < outside.size(); ++k) {
    Surroundings& around = all[static_cast<std::size_t>(outside[k].patch)];
    if (hosts) around.hosts_.push_back(holders[k]);
    around.where_[around.position(outside[k].site)] = hosts ? static_cast<Index>(around.hosts_.size()) : 1;
  }
  for (const EdgeRecord& record : gather_all(mesh.comm(), edges))
    all[static_cast<std::size_t>(record.patch)].sides_[static_cast<std::size_t>(record.side)].edges.push_back(
        record.edge);
  for (Surroundings& around : all) {
    if (around.known_) continue;
    for (Side& side : around.sides_)
      std::sort(side.edges.begin(), side.edges.end(), [](const Edge& a, const Edge& b) { return a.begin < b.begin; });
  }
  for (Surroundings& around : all)
    if (!around.known_) around.find_free_ends();
  return all;
}

void Surroundings::move_rows(const field::RowShift& shift)
{
  for (Side& side : sides_)
    for (Edge& edge : side.edges)
      for (auto* rows : {&edge.rows, &edge.sets})
        for (PetscInt& row : *rows)
          if (row >= 0) row = shift(row);
}
} // namespace pdx::couple
