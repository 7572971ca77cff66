#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
namespace pdx {
/// Number of a local object (cell, vertex, row, site). Equals PETSc's default PetscInt.
using Index = std::int32_t;
/// Small dense vector and matrix in space, SI units as the quantity says.
template <int Dim> using Vector = Eigen::Matrix<double, Dim, 1>;
template <int Dim> using Tensor = Eigen::Matrix<double, Dim, Dim>;
/// Site of a lattice or cell of a grid, counted per direction.
template <int Dim> using Site = std::array<Index, Dim>;
} // namespace pdx
