#include "pdx/base/petsc_version.hpp"
#include "pdx/mesh/build.hpp"

#include "pdx/mesh/straight_cut.hpp"

#include <algorithm>
#include <metis.h>
#include <numeric>
#include <optional>
#include <petsc/private/partitionerimpl.h>
#include <string_view>

namespace pdx::mesh {
namespace {
static_assert(std::is_same_v<idx_t, int> && std::is_same_v<PetscInt, int>, "the graph travels as MPI_INT");

/// Dual graph of the cells in METIS' form; whole on rank 0, empty elsewhere.
struct Graph {
  std::vector<idx_t> start{0}, neighbours, weights;
  idx_t size() const { return static_cast<idx_t>(weights.size()); }
};

/// How many items every rank holds; on rank 0 also where they begin in the gathered array.
struct Shares {
  std::vector<int> counts, begins;
  int total = 0;
};

Shares share(MPI_Comm comm, int mine)
{
  int size = 1;
  MPI_Comm_size(comm, &size);
  Shares shares{std::vector<int>(static_cast<std::size_t>(size)), std::vector<int>(static_cast<std::size_t>(size))};
  MPI_Allgather(&mine, 1, MPI_INT, shares.counts.data(), 1, MPI_INT, comm);
  std::exclusive_scan(shares.counts.begin(), shares.counts.end(), shares.begins.begin(), 0);
  shares.total = std::accumulate(shares.counts.begin(), shares.counts.end(), 0);
  return shares;
}

std::vector<int> gather(MPI_Comm comm, const Shares& shares, const int* mine, int count)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::vector<int> all(rank ? 0 : static_cast<std::size_t>(shares.total));
  MPI_Gatherv(mine, count, MPI_INT, all.data(), shares.counts.data(), shares.begins.data(), MPI_INT, 0, comm);
  return all;
}

std::vector<real_t> target_shares(PetscSection targets, PetscInt parts)
{
  std::vector<real_t> shares;
  if (!targets) return shares;
  for (PetscInt p = 0; p < parts; ++p) {
    PetscInt weight = 0;
    PDX_CALL(PetscSectionGetDof(targets, p, &weight));
    shares.push_back(static_cast<real_t>(weight));
  }
  const real_t sum = std::accumulate(shares.begin(), shares.end(), real_t{0});
  for (real_t& s : shares) s /= sum;
  return shares;
}

/// Consecutive cells of about equal weight per part; no part is empty if there are enough cells.
std::vector<idx_t> split_in_order(const Graph& graph, idx_t parts)
{
  const double total = std::accumulate(graph.weights.begin(), graph.weights.end(), 0.0);
  const idx_t cells = graph.size();
  std::vector<idx_t> part;
  double before = 0.0;
  for (idx_t c = 0, last = -1; c < cells; ++c) {
    const double weight = graph.weights[static_cast<std::size_t>(c)];
    const auto wanted = static_cast<idx_t>(parts * (before + 0.5 * weight) / total);
    const idx_t least = std::max({0, last, std::min(parts, cells) - cells + c}), most = std::min(last + 1, parts - 1);
    last = std::clamp(wanted, least, std::max(least, most));
    part.push_back(last);
    before += weight;
  }
  return part;
}

/// Gives every empty part a cell of the part with the most cells: METIS may leave some if few cells weigh most.
void fill_empty_parts(std::vector<idx_t>& part, idx_t parts)
{
  std::vector<idx_t> cells(static_cast<std::size_t>(parts), 0);
  for (idx_t p : part) ++cells[static_cast<std::size_t>(p)];
  for (idx_t p = 0; p < parts; ++p) {
    if (cells[static_cast<std::size_t>(p)] > 0) continue;
    const auto fullest = static_cast<idx_t>(std::max_element(cells.begin(), cells.end()) - cells.begin());
    *std::find(part.begin(), part.end(), fullest) = p;
    --cells[static_cast<std::size_t>(fullest)];
    ++cells[static_cast<std::size_t>(p)];
  }
}

/// Part of every cell; empty if METIS fails.
std::vector<idx_t> cut(Graph& graph, idx_t parts, std::vector<real_t> shares, idx_t& edges_cut)
{
  // METIS leaves parts of tiny graphs empty and complains about it on standard output.
  if (graph.size() < 8 * parts) return split_in_order(graph, parts);
  idx_t cells = graph.size(), constraints = 1;
  std::vector<idx_t> part(graph.weights.size(), 0);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_SEED] = 1; // the same cut in every run
  const int code = METIS_PartGraphKway(
      &cells, &constraints, graph.start.data(), graph.neighbours.data(), graph.weights.data(), nullptr, nullptr, &parts,
      shares.empty() ? nullptr : shares.data(), nullptr, options, &edges_cut, part.data());
  if (code != METIS_OK) return {};
  fill_empty_parts(part, parts);
  return part;
}

constexpr const char* kMiddles = "pdx_middles";
constexpr double kAsEven = 1.05; // heaviest part of a straight cut over that of METIS, at most

double heaviest(std::span<const idx_t> weights, std::span<const idx_t> part, idx_t parts)
{
  std::vector<double> sums(static_cast<std::size_t>(parts), 0.0);
  for (std::size_t c = 0; c < part.size(); ++c) sums[static_cast<std::size_t>(part[c])] += weights[c];
  return *std::ranges::max_element(sums);
}

idx_t faces_cut(const Graph& graph, std::span<const idx_t> part)
{
  idx_t twice = 0;
  for (idx_t c = 0; c < graph.size(); ++c)
    for (idx_t k = graph.start[static_cast<std::size_t>(c)]; k < graph.start[static_cast<std::size_t>(c) + 1]; ++k)
      twice += part[static_cast<std::size_t>(c)] !=
               part[static_cast<std::size_t>(graph.neighbours[static_cast<std::size_t>(k)])];
  return twice / 2;
}

/// Where the cells of the graph are, if that was noted [m].
std::optional<std::span<const Vector<2>>> middles_of(PetscPartitioner partitioner, const Graph& graph)
{
  PetscObject noted = nullptr;
  PDX_CALL(PetscObjectQuery(reinterpret_cast<PetscObject>(partitioner), kMiddles, &noted));
  if (!noted || graph.size() == 0) return std::nullopt;
  void* data = nullptr;
  PDX_CALL(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(noted), &data));
  const auto& middles = *static_cast<const std::vector<Vector<2>>*>(data);
  if (middles.size() != graph.weights.size()) return std::nullopt;
  return std::span<const Vector<2>>(middles);
}

/// A straight cut in the place of METIS' where it costs the busiest part less, or was asked for.
void prefer_straight(const Graph& graph, std::span<const Vector<2>> middles, idx_t parts, bool asked_for,
                     std::vector<idx_t>& part, idx_t& edges_cut)
{
  const PlacedCells cells{middles, graph.weights};
  std::vector<int> straight = straight_cut(cells, parts);
  std::vector<bool> used(static_cast<std::size_t>(parts), false);
  for (const int p : straight) used[static_cast<std::size_t>(p)] = true;
  if (std::ranges::count(used, true) < std::min(parts, graph.size())) return; // too few lines
  if (!asked_for && (heaviest(graph.weights, straight, parts) > kAsEven * heaviest(graph.weights, part, parts) ||
                     busiest_window(cells, straight, parts) >= busiest_window(cells, part, parts)))
    return;
  part = std::move(straight);
  edges_cut = faces_cut(graph, part);
}

void partition(PetscPartitioner partitioner, PetscInt parts, std::span<const PetscInt> start,
               const PetscInt* neighbours, PetscSection weights, PetscSection targets, std::vector<int>& mine)
{
  MPI_Comm comm = MPI_COMM_NULL;
  PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(partitioner), &comm));
  const int cells = static_cast<int>(mine.size());
  std::vector<int> degree(mine.size()), weight(mine.size(), 1);
  for (PetscInt c = 0; c < cells; ++c) {
    degree[static_cast<std::size_t>(c)] = start[static_cast<std::size_t>(c) + 1] - start[static_cast<std::size_t>(c)];
    if (weights) PDX_CALL(PetscSectionGetDof(weights, c, &weight[static_cast<std::size_t>(c)]));
  }
  const Shares vertex_shares = share(comm, cells);
  const int edges = cells ? start[mine.size()] : 0;
  const Shares edge_shares = share(comm, edges);
  Graph graph;
  const std::vector<int> degrees = gather(comm, vertex_shares, degree.data(), cells);
  for (int d : degrees) graph.start.push_back(graph.start.back() + d);
  graph.weights = gather(comm, vertex_shares, weight.data(), cells);
  graph.neighbours = gather(comm, edge_shares, neighbours, edges);
  std::vector<idx_t> part = cut(graph, parts, target_shares(targets, parts), partitioner->edgeCut);
  const std::string_view type = reinterpret_cast<PetscObject>(partitioner)->type_name;
  if (const auto middles = middles_of(partitioner, graph); middles && !part.empty() && type != "metis")
    prefer_straight(graph, *middles, parts, type == "straight", part, partitioner->edgeCut);
  int failed = part.size() != graph.weights.size();
  MPI_Bcast(&failed, 1, MPI_INT, 0, comm);
  if (failed) throw SolverFailure("METIS could not cut the mesh: try -petscpartitioner_type ptscotch");
  MPI_Scatterv(part.data(), vertex_shares.counts.data(), vertex_shares.begins.data(), MPI_INT, mine.data(), cells,
               MPI_INT, 0, comm);
}

/// PetscPartitioner's contract: `sizes` counts our vertices per part, `order` lists our vertices part by part.
PetscErrorCode partition_metis(PetscPartitioner partitioner, PetscInt parts, PetscInt vertices, PetscInt start[],
                               PetscInt neighbours[], PetscSection weights, PetscSection targets, PetscSection sizes,
                               IS* order)
{
  return guard([&] {
    std::vector<int> part(static_cast<std::size_t>(vertices));
    const std::size_t starts = vertices ? part.size() + 1 : 0;
    partition(partitioner, parts, std::span<const PetscInt>(start, starts), neighbours, weights, targets, part);
    std::vector<PetscInt> begin(static_cast<std::size_t>(parts) + 1, 0), listed(part.size());
    for (int p : part) ++begin[static_cast<std::size_t>(p) + 1];
    for (PetscInt p = 0; p < parts; ++p) {
      PDX_CALL(PetscSectionSetDof(sizes, p, begin[static_cast<std::size_t>(p) + 1]));
      begin[static_cast<std::size_t>(p) + 1] += begin[static_cast<std::size_t>(p)];
    }
    for (PetscInt v = 0; v < vertices; ++v)
      listed[static_cast<std::size_t>(begin[static_cast<std::size_t>(part[static_cast<std::size_t>(v)])]++)] = v;
    MPI_Comm comm = MPI_COMM_NULL;
    PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(partitioner), &comm));
    PDX_CALL(ISCreateGeneral(comm, vertices, listed.data(), PETSC_COPY_VALUES, order));
  });
}

PetscErrorCode create_metis(PetscPartitioner partitioner)
{
  partitioner->data = nullptr;
  partitioner->noGraph = PETSC_FALSE;
  partitioner->ops->partition = PartitionOperation<decltype(partitioner->ops->partition), partition_metis>::value;
  return 0;
}
} // namespace

void register_partitioners()
{
  static bool done = false;
  for (const char* type : {"auto", "metis", "straight"})
    if (!done) PDX_CALL(PetscPartitionerRegister(type, create_metis));
  done = true;
}

void note_middles(PetscPartitioner partitioner, const std::vector<Vector<2>>& middles)
{
  MPI_Comm comm = MPI_COMM_NULL;
  PetscContainer noted = nullptr;
  PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(partitioner), &comm));
  PDX_CALL(PetscContainerCreate(comm, &noted));
  PDX_CALL(PetscContainerSetPointer(noted, const_cast<std::vector<Vector<2>>*>(&middles)));
  PDX_CALL(
      PetscObjectCompose(reinterpret_cast<PetscObject>(partitioner), kMiddles, reinterpret_cast<PetscObject>(noted)));
  PDX_CALL(PetscContainerDestroy(&noted));
}
} // namespace pdx::mesh
