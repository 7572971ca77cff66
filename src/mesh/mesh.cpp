#include "pdx/mesh/mesh.hpp"

#include <algorithm>

namespace pdx::mesh {
namespace {
constexpr std::size_t kFew = 16; // cells that lists are told of one by one

MPI_Comm comm_of(const DmHandle& plex)
{
  MPI_Comm comm = MPI_COMM_NULL;
  PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(plex.get()), &comm));
  return comm;
}
} // namespace

Mesh::Mesh(DmHandle plex, MeshArrays arrays)
    : comm_(comm_of(plex)), plex_(std::move(plex)), arrays_(std::move(arrays)), use_(arrays_.cells.size(), Use::plain),
      uncovered_(use_), patch_(arrays_.cells.size(), -1), body_(arrays_.cells.size(), 0)
{}

std::array<Vector<2>, 4> Mesh::corners(Index c) const
{
  const auto& v = cell(c);
  return {point(v[0]), point(v[1]), point(v[2]), point(v[3])};
}

Vector<2> Mesh::centroid(Index c) const
{
  const auto x = corners(c);
  return 0.25 * (x[0] + x[1] + x[2] + x[3]);
}

const std::vector<BoundaryEdge>* Mesh::boundary(std::string_view name) const
{
  const auto found = arrays_.boundaries.find(name);
  return found == arrays_.boundaries.end() ? nullptr : &found->second;
}

std::vector<std::string> Mesh::boundary_names() const
{
  std::vector<std::string> names;
  for (const auto& [name, edges] : arrays_.boundaries) names.push_back(name);
  return names;
}

void Mesh::cover(Index c, int patch)
{
  PDX_ASSERT(patch >= 0);
  set_use(c, Use::covered);
  patch_[static_cast<std::size_t>(c)] = patch;
}

void Mesh::uncover(Index c)
{
  set_use(c, uncovered_[static_cast<std::size_t>(c)]);
  patch_[static_cast<std::size_t>(c)] = -1;
}

void Mesh::set_use(Index c, Use use)
{
  Use& now = use_[static_cast<std::size_t>(c)];
  if (listed_ && now != use) unlisted_.emplace_back(c, now);
  if (unlisted_.size() > kFew) listed_ = false;
  if (!listed_) unlisted_.clear();
  now = use;
}

void Mesh::cut(Index c)
{
  PDX_ASSERT(use(c) == Use::plain);
  set_use(c, Use::cut);
}

void Mesh::set_body(Index c, Index body, bool points)
{
  body_[static_cast<std::size_t>(c)] = body;
  use_[static_cast<std::size_t>(c)] = uncovered_[static_cast<std::size_t>(c)] = points ? Use::points : Use::plain;
  listed_ = false;
}

const CellFinder& Mesh::finder() const
{
  if (!finder_) finder_.emplace(arrays_.cells, arrays_.points);
  return *finder_;
}

std::span<const Index> Mesh::cells(Use wanted) const
{
  if (!listed_) {
    for (auto& list : lists_) list.clear();
    for (Index c = 0; c < cells(); ++c) lists_[static_cast<std::size_t>(use(c))].push_back(c);
    listed_ = true;
  }
  for (const auto& [c, before] : unlisted_) { // the first word on a cell is what lists know
    std::vector<Index>&from = lists_[static_cast<std::size_t>(before)], &to = lists_[static_cast<std::size_t>(use(c))];
    const auto at = std::ranges::lower_bound(from, c);
    if (at == from.end() || *at != c || before == use(c)) continue;
    from.erase(at);
    to.insert(std::ranges::lower_bound(to, c), c);
  }
  unlisted_.clear();
  return lists_[static_cast<std::size_t>(wanted)];
}

void Mesh::uncover()
{
  use_ = uncovered_;
  std::fill(patch_.begin(), patch_.end(), -1);
  listed_ = false;
}
} // namespace pdx::mesh
