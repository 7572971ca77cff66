#include "pdx/mesh/build.hpp"
#include "pdx/base/petsc_version.hpp"
#include "pdx/mesh/flatten.hpp"
#include "pdx/mesh/gmsh.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <numeric>
#include <petscdmplex.h>
#include <unordered_map>

namespace pdx::mesh {
namespace {
constexpr double kMostCells = std::numeric_limits<Index>::max() / 8.0; // cells, edges and vertices share one numbering

/// The whole mesh, on rank 0; edges of the outer boundary carry kBoundaryLabel.
struct SerialMesh {
  DmHandle plex;
  std::vector<std::string> boundaries; ///< the same on every rank
};

/// Documents, reads and judges PETSc's own option.
const char* partitioner_type()
{
#ifdef PETSC_HAVE_PTSCOTCH
  static constexpr const char* types[] = {"auto", "metis", "straight", "ptscotch", "simple"};
#else
  static constexpr const char* types[] = {"auto", "metis", "straight", "simple"};
#endif
  return types[Options("mesh").choice(
      "-petscpartitioner_type", 0, types,
      "how the mesh is cut for the ranks: metis, straight lines, or what of these costs less")];
}

void require_lower_below_upper(const geom::Box<2>& box)
{
  for (int d = 0; d < 2; ++d)
    if (!(box.lower[d] < box.upper[d]))
      throw UserError(fmt::format("-mesh_lower is {},{} and -mesh_upper {},{}: lower must be below upper in both "
                                  "directions",
                                  box.lower[0], box.lower[1], box.upper[0], box.upper[1]));
}

void broadcast(MPI_Comm comm, std::string& text)
{
  int size = static_cast<int>(text.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, comm);
  text.resize(static_cast<std::size_t>(size));
  MPI_Bcast(text.data(), size, MPI_CHAR, 0, comm);
}

SerialMesh box_mesh(MPI_Comm comm, const MeshOptions& options)
{
  require_lower_below_upper(options.box);
  if (options.cells[0] < 1 || options.cells[1] < 1)
    throw UserError(fmt::format("-mesh_cells is {},{}: a box needs at least 1 cell in both directions, e.g. "
                                "-mesh_cells 40,20",
                                options.cells[0], options.cells[1]));
  SerialMesh mesh;
  mesh.boundaries = {"bottom", "right", "top", "left"}; // markers 1 to 4 of "Face Sets"
  PDX_CALL(create_quadrilaterals(comm, options.cells.data(), options.box.lower.data(), options.box.upper.data(),
                                 mesh.plex.out()));
  DMLabel sides = nullptr;
  PetscInt first = 0, end = 0;
  PDX_CALL(DMCreateLabel(mesh.plex.get(), kBoundaryLabel));
  PDX_CALL(DMGetLabel(mesh.plex.get(), "Face Sets", &sides));
  PDX_CALL(DMPlexGetDepthStratum(mesh.plex.get(), 1, &first, &end));
  for (PetscInt e = first; sides && e < end; ++e) {
    PetscInt side = -1;
    PDX_CALL(DMLabelGetValue(sides, e, &side));
    if (side > 0) PDX_CALL(DMSetLabelValue(mesh.plex.get(), kBoundaryLabel, e, side - 1));
  }
  return mesh;
}

/// Rank 0 reads; all ranks learn whether that went well, and throw alike if not.
CellList read_on_first_rank(MPI_Comm comm, const std::string& file)
{
  CellList list;
  std::string error;
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank == 0) {
    try {
      list = read_gmsh(file);
    } catch (const std::exception& failure) {
      error = failure.what();
      if (error.empty()) error = fmt::format("-mesh_file {}: the file cannot be read", file);
    }
  }
  broadcast(comm, error);
  if (!error.empty()) throw UserError(error);
  int names = static_cast<int>(list.boundaries.size());
  MPI_Bcast(&names, 1, MPI_INT, 0, comm);
  list.boundaries.resize(static_cast<std::size_t>(names));
  for (std::string& name : list.boundaries) broadcast(comm, name);
  return list;
}

SerialMesh file_mesh(MPI_Comm comm, const MeshOptions& options)
{
  CellList& list = *options.list;
  SerialMesh mesh;
  const auto cells = static_cast<PetscInt>(list.cells.size()), vertices = static_cast<PetscInt>(list.points.size());
  std::vector<PetscInt> corners;
  std::vector<double> x;
  for (const auto& cell : list.cells) corners.insert(corners.end(), cell.begin(), cell.end());
  for (const auto& point : list.points) x.insert(x.end(), point.begin(), point.end());
  PDX_CALL(DMPlexCreateFromCellListPetsc(comm, 2, cells, vertices, 4, PETSC_TRUE, corners.data(), 2, x.data(),
                                         mesh.plex.out()));
  PDX_CALL(DMCreateLabel(mesh.plex.get(), kBoundaryLabel));
  for (const auto& [ends, name] : list.edges) {
    const std::array<PetscInt, 2> points{cells + ends[0], cells + ends[1]};
    PetscInt count = 0;
    const PetscInt* edge = nullptr;
    PDX_CALL(DMPlexGetJoin(mesh.plex.get(), 2, points.data(), &count, &edge));
    PDX_ASSERT(count == 1);
    PDX_CALL(DMSetLabelValue(mesh.plex.get(), kBoundaryLabel, edge[0], name));
    PDX_CALL(DMPlexRestoreJoin(mesh.plex.get(), 2, points.data(), &count, &edge));
  }
  mesh.boundaries = list.boundaries;
  return mesh;
}

/// What the cells of the serial mesh cost, in any order: on rank 0 all of them.
using Costs = std::function<std::vector<int>(const MeshArrays& serial)>;

Costs by_place(const CellCost& cost)
{
  return [&cost](const MeshArrays& serial) {
    std::vector<int> costs;
    for (const auto& v : serial.cells) {
      const auto corner = [&](std::size_t k) { return serial.points[static_cast<std::size_t>(v[k])]; };
      costs.push_back(cost ? cost({corner(0), corner(1), corner(2), corner(3)}) : 1);
    }
    return costs;
  };
}

Costs by_number(MeasuredCosts measured)
{
  return [measured = std::move(measured)](const MeshArrays& serial) {
    std::vector<int> costs;
    for (const Index number : serial.natural_cell)
      costs.push_back(measured.of_cell.at(static_cast<std::size_t>(number)));
    return costs;
  };
}

/// Natural numbers of the points of a mesh on one rank.
std::vector<Index> serial_numbers(DM plex)
{
  PetscInt points = 0, cells = 0, first_vertex = 0, end_vertex = 0;
  PDX_CALL(DMPlexGetChart(plex, nullptr, &points));
  std::vector<Index> natural(static_cast<std::size_t>(points), -1);
  if (points == 0) return natural;
  PDX_CALL(DMPlexGetDepthStratum(plex, 2, nullptr, &cells));
  PDX_CALL(DMPlexGetDepthStratum(plex, 0, &first_vertex, &end_vertex));
  std::iota(natural.begin(), natural.begin() + cells, 0);
  std::iota(natural.begin() + first_vertex, natural.begin() + end_vertex, 0);
  return natural;
}

/// The partitioner takes the number of unknowns of a cell for its weight: says the costs in such a section, and notes
/// them by point.
/// Returns the middles of the cells, by point [m].
std::vector<Vector<2>> set_costs(DistributedPlex& serial, const Costs& cost)
{
  MPI_Comm comm = MPI_COMM_NULL;
  PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(serial.plex.get()), &comm));
  const MeshArrays arrays = flatten(serial, {});
  const std::vector<int> costs = cost(arrays);
  constexpr double kLargestSum = 5e8; // METIS counts in 32 bits
  const double shrink = std::min(1.0, kLargestSum / std::accumulate(costs.begin(), costs.end(), 1.0));
  SectionHandle weights;
  PDX_CALL(PetscSectionCreate(comm, weights.out()));
  PDX_CALL(PetscSectionSetChart(weights.get(), 0, static_cast<PetscInt>(costs.size())));
  serial.costs.assign(serial.natural.size(), 0);
  std::vector<Vector<2>> middles(costs.size());
  for (std::size_t c = 0; c < costs.size(); ++c) {
    PDX_ASSERT(costs[c] > 0);
    const Index cell = arrays.natural_cell[c]; // the point, too
    serial.costs[static_cast<std::size_t>(cell)] = costs[c];
    Vector<2>& middle = middles[static_cast<std::size_t>(cell)] = Vector<2>::Zero();
    for (const Index v : arrays.cells[c]) middle += 0.25 * arrays.points[static_cast<std::size_t>(v)];
    PDX_CALL(PetscSectionSetDof(weights.get(), cell, std::max(1, static_cast<PetscInt>(shrink * costs[c]))));
  }
  PDX_CALL(PetscSectionSetUp(weights.get()));
  PDX_CALL(DMSetLocalSection(serial.plex.get(), weights.get()));
  return middles;
}

/// What is known by point goes where the points go.
std::vector<int> spread(PetscSF migration, const std::vector<int>& serial, DM to)
{
  PetscInt points = 0;
  PDX_CALL(DMPlexGetChart(to, nullptr, &points));
  std::vector<int> mine(static_cast<std::size_t>(points), -1);
  PDX_CALL(PetscSFBcastBegin(migration, MPI_INT, serial.data(), mine.data(), MPI_REPLACE));
  PDX_CALL(PetscSFBcastEnd(migration, MPI_INT, serial.data(), mine.data(), MPI_REPLACE));
  return mine;
}

DistributedPlex distribute(DistributedPlex serial, const char* type, const Costs& cost)
{
  PDX_CALL(DMPlexDistributeSetDefault(serial.plex.get(), PETSC_FALSE));
  int size = 1;
  MPI_Comm comm = MPI_COMM_NULL;
  PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(serial.plex.get()), &comm));
  MPI_Comm_size(comm, &size);
  if (size == 1) return serial;
  const std::vector<Vector<2>> middles = set_costs(serial, cost);
  PetscPartitioner partitioner = nullptr;
  PDX_CALL(DMPlexGetPartitioner(serial.plex.get(), &partitioner));
  PDX_CALL(PetscPartitionerSetType(partitioner, type));
  PDX_CALL(PetscPartitionerSetFromOptions(partitioner));
  PDX_CALL(PetscPartitionerSetType(partitioner, type)); // the option is for the first cut
  note_middles(partitioner, middles);
  DistributedPlex result;
  SfHandle migration;
  PDX_CALL(DMPlexDistribute(serial.plex.get(), 1, migration.out(), result.plex.out()));
  PDX_CALL(DMPlexDistributeSetDefault(result.plex.get(), PETSC_FALSE));
  result.natural = spread(migration.get(), serial.natural, result.plex.get());
  result.costs = spread(migration.get(), serial.costs, result.plex.get());
  return result;
}

/// Largest cost of a rank's own cells over the mean.
double imbalance(MPI_Comm comm, const DistributedPlex& plex, const MeshArrays& arrays)
{
  int size = 1;
  MPI_Comm_size(comm, &size);
  if (size == 1) return 1.0;
  PetscInt cells = 0;
  PDX_CALL(DMPlexGetHeightStratum(plex.plex.get(), 0, nullptr, &cells));
  std::unordered_map<Index, int> cost_of;
  for (std::size_t p = 0; p < static_cast<std::size_t>(cells); ++p) cost_of[plex.natural[p]] = plex.costs[p];
  double mine = 0.0;
  for (Index c = 0; c < arrays.owned_cells; ++c) mine += cost_of.at(arrays.natural_cell[static_cast<std::size_t>(c)]);
  double sum = 0.0, largest = 0.0;
  MPI_Allreduce(&mine, &sum, 1, MPI_DOUBLE, MPI_SUM, comm);
  MPI_Allreduce(&mine, &largest, 1, MPI_DOUBLE, MPI_MAX, comm);
  return largest * size / sum;
}
} // namespace

MeshOptions MeshOptions::read(bool needed)
{
  Options options("mesh");
  MeshOptions o;
  o.file = options.text("-mesh_file", "", "Gmsh file (2.2 or 4.1) of four-node cells; takes the place of a box");
  const auto lower = options.reals("-mesh_lower", {}, 2, "m", "lower left corner of a box");
  const auto upper = options.reals("-mesh_upper", {}, 2, "m", "upper right corner of a box");
  const auto cells = options.integers("-mesh_cells", {0, 0}, 2, "cells of a box per direction");
  (void)partitioner_type();
  if (options.given("-mesh_cells") && (cells[0] < 1 || cells[1] < 1))
    throw UserError(fmt::format("-mesh_cells is {},{}: must be at least 1 in both directions", cells[0], cells[1]));
  if (const double count = static_cast<double>(cells[0]) * cells[1]; count > kMostCells)
    throw UserError(fmt::format("-mesh_cells is {},{}: makes {:.3g} cells, more than the {:.3g} that can be numbered",
                                cells[0], cells[1], count, kMostCells));
  o.cells = {cells[0], cells[1]};
  if (!o.file.empty()) return o;
  if (!needed && lower.empty() && upper.empty()) return o;
  if (lower.empty() || upper.empty())
    throw UserError("there is no mesh: give -mesh_file FILE, or a box by -mesh_lower x,y -mesh_upper x,y "
                    "-mesh_cells nx,ny, or a body without one by -mpm_bodies or -pd_cloud (pdxsolve -help lists all "
                    "options)");
  o.box = {{lower[0], lower[1]}, {upper[0], upper[1]}};
  require_lower_below_upper(o.box);
  return o;
}

double load(MPI_Comm comm, MeshOptions& options)
{
  options.list = std::make_shared<CellList>(read_on_first_rank(comm, options.file));
  constexpr double far = std::numeric_limits<double>::max();
  double least[] = {far, far, far, far, far}; // x, y, -x, -y, edge
  for (const Vector<2>& x : options.list->points)
    for (std::size_t d = 0; d < 2; ++d) {
      least[d] = std::min(least[d], x[static_cast<Eigen::Index>(d)]);
      least[2 + d] = std::min(least[2 + d], -x[static_cast<Eigen::Index>(d)]);
    }
  const auto point = [&](Index v) { return options.list->points[static_cast<std::size_t>(v)]; };
  for (const auto& cell : options.list->cells)
    for (std::size_t k = 0; k < 4; ++k)
      least[4] = std::min(least[4], (point(cell[(k + 1) % 4]) - point(cell[k])).norm());
  MPI_Bcast(least, 5, MPI_DOUBLE, 0, comm);
  options.box = {{least[0], least[1]}, {-least[2], -least[3]}};
  return least[4];
}

namespace {
Mesh cut_and_flatten(MPI_Comm comm, const MeshOptions& given, const char* type, const Costs& costs)
{
  MeshOptions options = given;
  if (!options.file.empty() && !options.list) (void)load(comm, options);
  register_partitioners();
  SerialMesh serial = options.file.empty() ? box_mesh(comm, options) : file_mesh(comm, options);
  std::vector<Index> natural = serial_numbers(serial.plex.get());
  DistributedPlex distributed = distribute({std::move(serial.plex), std::move(natural), {}}, type, costs);
  MeshArrays arrays = flatten(distributed, serial.boundaries);
  arrays.quality.imbalance = imbalance(comm, distributed, arrays);
  return {std::move(distributed.plex), std::move(arrays)};
}
} // namespace

Mesh build(MPI_Comm comm, const MeshOptions& options, const CellCost& cost)
{
  if (options.list && !options.list->costs.empty())
    return cut_and_flatten(comm, options, partitioner_type(), by_number({options.list->costs}));
  return cut_and_flatten(comm, options, partitioner_type(), by_place(cost));
}

Mesh build_by_costs(MPI_Comm comm, const MeshOptions& options, const MeasuredCosts& costs)
{
  return cut_and_flatten(comm, options, "auto", by_number(costs));
}
} // namespace pdx::mesh
