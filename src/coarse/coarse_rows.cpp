#include "pdx/base/gather.hpp"
#include "pdx/coarse/coarse_mesh.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::coarse {
namespace {
Vector<2> middle_of(const couple::Surroundings& around)
{
  return 0.5 * (around.shape().box.lower + around.shape().box.upper);
}
} // namespace

void CoarseMesh::gather_sets()
{
  if (!fine_.sets) return;
  std::vector<SetRecord> mine;
  for (Index k = 0; k < fine_.sets->owned(); ++k) {
    const Index vertex = fine_.sets->vertices()[static_cast<std::size_t>(k)];
    const PetscInt row = system_.rows.first + system_.rows.nodes + k;
    for (const xfem::EnrichedSet& set : fine_.sets->of(vertex))
      if (set.row == row)
        mine.push_back({row, fine_.node_rows[static_cast<std::size_t>(vertex)],
                        xfem::shifted_step(xfem::opposite(set.side), set.side)});
  }
  for (const SetRecord& record : gather_all(body_.mesh.comm(), mine)) sets_.emplace(record.set, record);
}

/// A row's entries come from all cells that touch its node: cells at nodes of ours, those that lean on our elements,
/// and (to interpolate only) those of our particles.
void CoarseMesh::choose_cells()
{
  enum : std::uint8_t { away, looked_at, assembled };
  std::vector<couple::CellParticle> particles;
  place_.clear();
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    const PatchGrid& grid = grids_[p];
    const auto& lattice = grid.part().lattice();
    std::vector<std::uint8_t> state(static_cast<std::size_t>(grid.cells()), away);
    for (const Index number : grid.part().sites())
      state[static_cast<std::size_t>(grid.cell_of(grid.part().site(number)))] = looked_at;
    const auto take = [&](Index cell) { state[static_cast<std::size_t>(cell)] = assembled; };
    for (const Index node : grid.owned()) grid.for_each_cell_at(node, take);
    for (Index node = 0; node < grid.nodes(); ++node) {
      if (!grid.carried(node)) continue;
      const couple::Host host = grid.host(node, middle_of(fine_.around[p]));
      const std::span rows(host.rows.data(), static_cast<std::size_t>(host.count));
      if (std::ranges::any_of(rows, [&](PetscInt row) { return system_.rows.owns(row); }))
        grid.for_each_cell_at(node, take);
    }
    place_.emplace_back(state.size(), Index{-1});
    for (Index c = 0; c < grid.cells(); ++c) {
      if (state[static_cast<std::size_t>(c)] == away) continue;
      const auto number = static_cast<Index>(cells_.size());
      place_[p][static_cast<std::size_t>(c)] = number;
      cells_.push_back({static_cast<int>(p), c, state[static_cast<std::size_t>(c)] == assembled});
      if (!fine_.breakable || !cells_.back().assembled) continue;
      const auto [lower, upper] = grid.sites(c);
      for (Site<2> site = lower; site[1] < upper[1]; ++site[1])
        for (site[0] = lower[0]; site[0] < upper[0]; ++site[0])
          particles.push_back({static_cast<int>(p), number, grid.part().number(site), lattice.point(site)});
    }
  }
  if (fine_.breakable)
    support_ = std::make_unique<couple::SupportParts>(system_.rows, fine_.parts, std::move(particles),
                                                      static_cast<Index>(cells_.size()));
}

/// Splits our nodes around which bonds are broken. Until rows are numbered, row 0 stands for the node's first row, and
/// 1, 2, ... for the further parts of all nodes.
std::vector<CoarseMesh::SplitRecord> CoarseMesh::split_nodes(Index& extra)
{
  std::vector<SplitRecord> records;
  for (std::size_t p = 0; p < grids_.size(); ++p)
    for (const Index node : grids_[p].owned()) {
      std::vector<Index> around;
      bool damaged = false;
      grids_[p].for_each_cell_at(node, [&](Index cell) {
        around.push_back(place_[p][static_cast<std::size_t>(cell)]);
        damaged = damaged || support_->damaged(around.back());
      });
      if (!damaged) continue;
      const auto weight = [&](const couple::CellParticle& particle) {
        const Index cell = cells_[static_cast<std::size_t>(particle.cell)].cell;
        const auto corners = grids_[p].corners(cell);
        const auto at = std::ranges::find(corners, node) - corners.begin();
        return grids_[p].weights(cell, particle.x)[static_cast<std::size_t>(at)];
      };
      const std::vector<couple::PartOfNode> parts = support_->split(around, weight);
      const auto most = std::ranges::max(parts, {}, &couple::PartOfNode::part).part;
      if (most == 0 && std::ranges::min(parts, {}, &couple::PartOfNode::part).part == 0) continue;
      for (const couple::PartOfNode& part : parts)
        records.push_back({static_cast<int>(p), node, support_->particles()[part.particle].site,
                           part.part <= 0 ? part.part : extra + part.part});
      for (int k = 1; k <= most; ++k) extra_points_.push_back(grids_[p].point(node));
      extra += std::max(0, most);
    }
  return records;
}

PetscInt CoarseMesh::coarse_of(PetscInt fine) const
{
  const auto rank = static_cast<std::size_t>(std::ranges::upper_bound(fine_first_, fine) - fine_first_.begin() - 1);
  return fine - fine_first_[rank] + coarse_first_[rank];
}

void CoarseMesh::number(Index extra, std::vector<SplitRecord> mine)
{
  const MPI_Comm comm = body_.mesh.comm();
  const Index elements = system_.rows.nodes + system_.rows.enriched;
  Index owned = elements;
  for (const PatchGrid& grid : grids_) owned += static_cast<Index>(grid.owned().size());
  rows_ = field::Rows::number(comm, 2, owned + extra, 0, 0);
  coarse_first_ = gather_all(comm, std::vector<PetscInt>{rows_.first});

  std::vector<PetscInt> needed;
  for (const PetscInt row : fine_.node_rows)
    if (row >= 0) needed.push_back(coarse_of(row));
  for (const auto& [row, record] : sets_) needed.push_back(coarse_of(row)); // few: along the cracks
  for (const auto& [row, record] : sets_) needed.push_back(coarse_of(record.node));
  std::vector<std::vector<Index>> asked(grids_.size());
  for (const GridCell& c : cells_) {
    const auto p = static_cast<std::size_t>(c.patch);
    for (const Index node : grids_[p].corners(c.cell)) {
      if (!grids_[p].carried(node)) {
        asked[p].push_back(node);
        continue;
      }
      const couple::Host host = grids_[p].host(node, middle_of(fine_.around[p]));
      for (std::size_t k = 0; k < static_cast<std::size_t>(host.count); ++k) needed.push_back(coarse_of(host.rows[k]));
    }
  }
  std::vector<std::vector<PetscInt>> found;
  PetscInt first = rows_.first + elements;
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    std::ranges::sort(asked[p]);
    asked[p].erase(std::unique(asked[p].begin(), asked[p].end()), asked[p].end());
    const pd::SiteDirectory directory(comm, grids_[p].nodes(), grids_[p].owned(), first);
    found.push_back(directory.rows(asked[p]));
    needed.insert(needed.end(), found[p].begin(), found[p].end());
    for (SplitRecord& r : mine) {
      if (r.patch != static_cast<int>(p) || r.row < 0) continue;
      const auto at = std::ranges::lower_bound(grids_[p].owned(), r.node) - grids_[p].owned().begin();
      r.row = r.row == 0 ? first + static_cast<PetscInt>(at) : rows_.first + owned + r.row - 1;
    }
    first += static_cast<PetscInt>(grids_[p].owned().size());
  }
  std::vector<SplitRecord> records;
  if (support_) records = gather_all(comm, mine);
  std::erase_if(records, [&](const SplitRecord& r) {
    return !std::ranges::binary_search(asked[static_cast<std::size_t>(r.patch)], r.node);
  });
  for (const SplitRecord& r : records) needed.push_back(r.row);

  halo_ = std::make_unique<field::RowHalo>(rows_, needed);
  vertex_rows_.clear();
  for (const PetscInt row : fine_.node_rows) vertex_rows_.push_back(row < 0 ? -1 : halo_->local(coarse_of(row)));
  grid_rows_.clear();
  for (std::size_t p = 0; p < grids_.size(); ++p) {
    grid_rows_.emplace_back(static_cast<std::size_t>(grids_[p].nodes()), Index{-1});
    for (std::size_t k = 0; k < asked[p].size(); ++k)
      grid_rows_[p][static_cast<std::size_t>(asked[p][k])] = halo_->local(found[p][k]);
  }
  split_.clear();
  weak_.clear();
  for (const SplitRecord& r : records) {
    const Index row = r.row < 0 ? -1 : halo_->local(r.row);
    split_[{r.patch, r.node}].emplace_back(r.site, row);
    if (row >= 0 && row < rows_.owned()) weak_.push_back(row);
  }
  for (auto& [key, leaning] : split_) std::ranges::sort(leaning);
  std::ranges::sort(weak_);
  weak_.erase(std::unique(weak_.begin(), weak_.end()), weak_.end());
}

CoarseMesh::Corner CoarseMesh::carried_corner(int patch, Index node, const Vector<2>& x) const
{
  Corner corner;
  const auto add = [&](PetscInt fine, double factor) {
    const Index row = halo_->local(coarse_of(fine));
    const auto at = std::ranges::find(corner, row, &Share::row);
    if (at == corner.end())
      corner.push_back({row, factor});
    else
      at->factor += factor;
  };
  const couple::Host host = grids_[static_cast<std::size_t>(patch)].host(node, x);
  for (std::size_t k = 0; k < static_cast<std::size_t>(host.count); ++k) {
    const auto set = sets_.find(host.rows[k]);
    if (set == sets_.end()) {
      add(host.rows[k], host.weights[k]);
      continue;
    }
    add(set->first, host.weights[k] / set->second.factor);
    add(set->second.node, -host.weights[k] / set->second.factor);
  }
  std::erase_if(corner, [](const Share& share) { return std::abs(share.factor) < 1e-14; });
  return corner;
}

/// What a particle leans on at a node of its patch's grid.
CoarseMesh::Corner CoarseMesh::corner(int patch, Index node, Index site, const Vector<2>& x) const
{
  const auto p = static_cast<std::size_t>(patch);
  if (grids_[p].carried(node)) return carried_corner(patch, node, x);
  const auto split = split_.find({patch, node});
  if (split == split_.end()) return {{grid_rows_[p][static_cast<std::size_t>(node)], 1.0}};
  const auto at = std::ranges::lower_bound(split->second, site, {}, &std::pair<Index, Index>::first);
  if (at == split->second.end() || at->first != site || at->second < 0) return {};
  return {{at->second, 1.0}};
}

std::vector<double> CoarseMesh::coordinates() const
{
  std::vector<double> x(system_.coordinates.begin(),
                        system_.coordinates.begin() + 2 * static_cast<std::ptrdiff_t>(system_.rows.first_particle()));
  const auto add = [&](const Vector<2>& point) { x.insert(x.end(), {point[0], point[1]}); };
  for (const PatchGrid& grid : grids_)
    for (const Index node : grid.owned()) add(grid.point(node));
  for (const Vector<2>& point : extra_points_) add(point);
  return x;
}
} // namespace pdx::coarse
