#pragma once
#include "pdx/fem/elastic_term.hpp"
#include "pdx/fem/loads.hpp"
#include "pdx/mesh/vertex_halo.hpp"
#include "support/tangent.hpp"

#include <functional>
#include <limits>
#include <memory>
#include <optional>

namespace pdx::test {
/// Prescribed displacement [m] of component `axis` of the node at x, or none.
using Prescribed = std::function<std::optional<double>(const Vector<2>& x, int axis)>;

/// A plain elastic body: rows for the vertices of plain cells, one ElasticTerm, dead loads, Newton with CG.
class ElasticProblem {
public:
  /// Collective. The mesh must outlive the problem.
  ElasticProblem(const mesh::Mesh& mesh, const law::Elastic& law, law::Kinematics kinematics)
      : mesh_(mesh), body_{mesh, law, kinematics}, node_rows_(number_nodes(mesh, rows_)),
        term_(mesh, law, kinematics, node_rows_), force_(2 * static_cast<std::size_t>(rows_.owned()), 0.0)
  {
    std::vector<PetscInt> needed;
    term_.needed_rows(needed);
    halo_ = std::make_unique<field::RowHalo>(rows_, std::move(needed));
    term_.bind(*halo_);
    owned_u_.assign(force_.size(), 0.0);
    held_.assign(2 * static_cast<std::size_t>(halo_->size()), 0);
  }

  const field::Rows& rows() const { return rows_; }
  const field::RowHalo& halo() const { return *halo_; }
  const std::vector<PetscInt>& node_rows() const { return node_rows_; }
  const fem::ElasticBody& body() const { return body_; }
  fem::ElasticTerm& term() { return term_; }
  fem::NodalForces loads() { return {node_rows_, rows_, force_}; }
  const std::vector<double>& force() const { return force_; } ///< applied, owned rows [N]

  /// Sets the displacement of all owned rows and notes what is prescribed. Collective.
  void prescribe(const Prescribed& prescribed)
  {
    std::vector<double> flags(force_.size(), 0.0);
    for (Index v = 0; v < mesh_.owned_vertices(); ++v)
      for (int axis = 0; axis < 2; ++axis) {
        const PetscInt row = node_rows_[static_cast<std::size_t>(v)];
        const auto value = row < 0 ? std::nullopt : prescribed(mesh_.point(v), axis);
        if (!value) continue;
        const auto at = static_cast<std::size_t>(2 * (row - rows_.first) + axis);
        owned_u_[at] = *value;
        flags[at] = 1.0;
      }
    std::vector<double> all;
    halo_->fetch(flags, 2, all);
    for (std::size_t i = 0; i < all.size(); ++i) held_[i] = all[i] > 0.5;
  }

  /// Nothing is prescribed any more; displacements stay.
  void release() { std::fill(held_.begin(), held_.end(), 0); }

  /// Displacement of [owned | halo] rows. Collective.
  std::vector<double> local_displacement() const
  {
    std::vector<double> u;
    halo_->fetch(owned_u_, 2, u);
    return u;
  }

  /// Internal force of the owned rows [N]. Collective.
  std::vector<double> internal_force() const
  {
    std::vector<double> r(force_.size(), 0.0);
    term_.add_residual(local_displacement(), r);
    return r;
  }

  /// The tangent at the present displacement. Collective.
  MatHandle tangent()
  {
    return tangent_of({&term_}, *halo_, held_, local_displacement(), body_.law.young * body_.law.thickness);
  }

  /// Newton from the prescribed displacement; returns the number of linear solves, -1 if it failed. Collective.
  int solve()
  {
    double first = 0.0;
    for (int k = 0; k < 20; ++k) {
      VecHandle rest = rows_.vector(), step = rows_.vector();
      const double norm = fill_unbalanced(rest.get());
      if (k == 0) first = norm;
      if (norm <= 1e-10 * first) return k;
      const MatHandle matrix = tangent();
      KspHandle ksp;
      PDX_CALL(KSPCreate(rows_.comm, ksp.out()));
      PDX_CALL(KSPSetOperators(ksp.get(), matrix.get(), matrix.get()));
      PDX_CALL(KSPSetType(ksp.get(), KSPCG));
      PDX_CALL(KSPSetTolerances(ksp.get(), 1e-12, PETSC_DEFAULT, PETSC_DEFAULT, 5000));
      PC pc = nullptr;
      PDX_CALL(KSPGetPC(ksp.get(), &pc));
      PDX_CALL(PCSetType(pc, PCBJACOBI));
      PDX_CALL(KSPSolve(ksp.get(), rest.get(), step.get()));
      const double* d = nullptr;
      PDX_CALL(VecGetArrayRead(step.get(), &d));
      for (std::size_t i = 0; i < owned_u_.size(); ++i) owned_u_[i] += d[i];
      PDX_CALL(VecRestoreArrayRead(step.get(), &d));
    }
    return -1;
  }

  /// Displacement of every local vertex, 2 each; not-a-number where a vertex has no row here. Collective.
  std::vector<double> vertex_displacement() const
  {
    const std::size_t owned = 2 * static_cast<std::size_t>(mesh_.owned_vertices());
    std::vector<double> all(2 * static_cast<std::size_t>(mesh_.vertices()), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < owned; ++i) {
      const PetscInt row = node_rows_[i / 2];
      if (row >= 0) all[i] = owned_u_[2 * static_cast<std::size_t>(row - rows_.first) + i % 2];
    }
    mesh::fill_halo(mesh_, MPI_DOUBLE, 2, all.data());
    return all;
  }

private:
  static std::vector<PetscInt> number_nodes(const mesh::Mesh& mesh, field::Rows& rows)
  {
    std::vector<PetscInt> node_rows(static_cast<std::size_t>(mesh.vertices()), -1);
    std::vector<std::uint8_t> active(node_rows.size(), 0);
    for (const Index c : mesh.cells(mesh::Use::plain))
      for (const Index v : mesh.cell(c)) active[static_cast<std::size_t>(v)] = 1;
    Index nodes = 0;
    for (Index v = 0; v < mesh.owned_vertices(); ++v) nodes += active[static_cast<std::size_t>(v)];
    rows = field::Rows::number(mesh.comm(), 2, nodes, 0, 0);
    PetscInt next = rows.first;
    for (Index v = 0; v < mesh.owned_vertices(); ++v)
      if (active[static_cast<std::size_t>(v)]) node_rows[static_cast<std::size_t>(v)] = next++;
    mesh::fill_halo(mesh, MPIU_INT, 1, node_rows.data());
    return node_rows;
  }

  /// rest = applied - internal force at free components, 0 at prescribed ones; returns its norm.
  double fill_unbalanced(Vec rest) const
  {
    const std::vector<double> inner = internal_force();
    double* values = nullptr;
    PDX_CALL(VecGetArray(rest, &values));
    for (std::size_t i = 0; i < inner.size(); ++i) values[i] = held_[i] ? 0.0 : force_[i] - inner[i];
    PDX_CALL(VecRestoreArray(rest, &values));
    double norm = 0.0;
    PDX_CALL(VecNorm(rest, NORM_2, &norm));
    return norm;
  }

  const mesh::Mesh& mesh_;
  fem::ElasticBody body_;
  field::Rows rows_;
  std::vector<PetscInt> node_rows_;
  fem::ElasticTerm term_;
  std::vector<double> force_, owned_u_;
  std::unique_ptr<field::RowHalo> halo_;
  std::vector<std::uint8_t> held_;
};

/// Sum over ranks. Collective.
inline double sum_all(MPI_Comm comm, double mine)
{
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, comm);
  return mine;
}
} // namespace pdx::test
