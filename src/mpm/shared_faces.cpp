#include "shared_faces.hpp"

#include "pdx/base/exchange.hpp"

#include <algorithm>
#include <numeric>

namespace pdx::mpm {
namespace {
/// One cell's view of a face.
template <int Dim> struct Face {
  std::array<PetscInt, static_cast<std::size_t>(kCorners<Dim> / 2)> rows; ///< of its corners, in order: its name
  std::uint16_t parts, number;                                            ///< next to points; face of the cell
  std::size_t cell;
};

template <int Dim>
std::vector<Face<Dim>> faces_of(std::span<const PointCell<Dim>> cells, std::span<const BodyMaterial> bodies)
{
  std::vector<Face<Dim>> faces;
  faces.reserve(cells.size() * 2 * Dim);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto parts = points_at_faces<Dim>(bodies[static_cast<std::size_t>(cells[k].body)].ratio, cells[k].points);
    for (std::size_t face = 0; face < parts.size(); ++face) {
      if (!parts[face]) continue;
      faces.push_back({{}, parts[face], static_cast<std::uint16_t>(face), k});
      std::size_t next = 0;
      for (std::size_t a = 0; a < cells[k].rows.size(); ++a)
        if ((a >> face / 2 & 1) == face % 2) faces.back().rows[next++] = cells[k].rows[a];
    }
  }
  return faces;
}

/// Calls visit(k, l) for faces of one name.
template <int Dim, class Visit> void for_each_pair(std::span<const Face<Dim>> faces, Visit&& visit)
{
  std::vector<std::size_t> order(faces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return faces[k].rows; });
  for (std::size_t k = 1; k < order.size(); ++k)
    if (faces[order[k - 1]].rows == faces[order[k]].rows) visit(order[k - 1], order[k]);
}
} // namespace

std::vector<PetscInt> first_rows(const field::Rows& rows)
{
  int ranks = 1;
  MPI_Comm_size(rows.comm, &ranks);
  std::vector<PetscInt> first(static_cast<std::size_t>(ranks));
  MPI_Allgather(&rows.first, 1, MPIU_INT, first.data(), 1, MPIU_INT, rows.comm);
  return first;
}

int owner_of(PetscInt row, std::span<const PetscInt> first)
{
  return static_cast<int>(std::ranges::upper_bound(first, row) - first.begin()) - 1;
}

template <int Dim>
std::vector<SharedParts<Dim>> find_shared_faces(const field::Rows& rows, std::span<const PointCell<Dim>> cells,
                                                std::span<const BodyMaterial> bodies)
{
  std::vector<SharedParts<Dim>> shared(cells.size(), SharedParts<Dim>{});
  const std::vector<Face<Dim>> faces = faces_of<Dim>(cells, bodies);
  std::vector<std::uint8_t> found(faces.size(), 0);
  for_each_pair<Dim>(faces, [&](std::size_t k, std::size_t l) {
    for (const std::size_t one : {k, l}) {
      shared[faces[one].cell][faces[one].number] = faces[k].parts & faces[l].parts;
      found[one] = 1;
    }
  });
  const std::vector<PetscInt> first = first_rows(rows);
  std::vector<Face<Dim>> rest;
  std::vector<int> to;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (found[k]) continue;
    rest.push_back(faces[k]);
    to.push_back(owner_of(faces[k].rows[0], first));
  }
  const auto sent = sort_by_rank<Face<Dim>>(rest, to, static_cast<int>(first.size()));
  const auto come = exchange(rows.comm, sent);
  Parcels<std::uint16_t> answers{std::vector<std::uint16_t>(come.records.size(), 0), come.counts};
  for_each_pair<Dim>(come.records, [&](std::size_t k, std::size_t l) {
    answers.records[k] = answers.records[l] = come.records[k].parts & come.records[l].parts;
  });
  const auto back = exchange(rows.comm, answers);
  for (std::size_t k = 0; k < sent.records.size(); ++k)
    shared[sent.records[k].cell][sent.records[k].number] = back.records[k];
  return shared;
}

template std::vector<SharedParts<2>> find_shared_faces<2>(const field::Rows&, std::span<const PointCell<2>>,
                                                          std::span<const BodyMaterial>);
template std::vector<SharedParts<3>> find_shared_faces<3>(const field::Rows&, std::span<const PointCell<3>>,
                                                          std::span<const BodyMaterial>);
} // namespace pdx::mpm
