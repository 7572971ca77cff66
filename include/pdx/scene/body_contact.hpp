#pragma once
#include "pdx/couple/contact_books.hpp"
#include "pdx/couple/contact_term.hpp"
#include "pdx/scene/model.hpp"
#include "pdx/scene/point_output.hpp"

namespace pdx::scene {
/// Contact between the bodies of a scene: its Term and its books, which the System owns.
template <int Dim> class BodyContact final : public Touching {
public:
  BodyContact(couple::ContactTerm<Dim>& term, couple::ContactBooks& books, MPI_Comm comm)
      : term_(term), books_(books), comm_(comm)
  {}
  void add_energies(std::span<const double> local, post::Energies& mine) const override;
  const couple::ContactBooks* books() const override { return &books_; }
  std::vector<double> sums() const override { return books_.sums(); }
  void resume(std::span<const double> sums) override { books_.resume(sums); }
  std::optional<NamedGrips> grips() const override;
  void hold(const NamedGrips& grips) override;

private:
  couple::ContactTerm<Dim>& term_;
  couple::ContactBooks& books_;
  MPI_Comm comm_;
};

/// Adds contact to a scene whose rows are numbered, if its bodies may touch. Collective. Throws UserError for bodies
/// that overlap.
/// @param points at the surface of bodies, which are numbered as in `bodies`; called where they may
template <int Dim>
void add_contact(const options::SceneOptions& options, std::vector<couple::ContactBody> bodies,
                 const std::function<std::vector<couple::SurfacePoint<Dim>>()>& points, Model& model);

/// Names and moduli of the bodies of points of a plan.
template <int Dim> std::vector<couple::ContactBody> touching_bodies(const PointPlan<Dim>& plan);

/// Surface points among the material points of a Term, of the cells that this rank gave it: half a spacing within the
/// border that their body's shape has.
/// @param cells of the Term, in their order   @param by_sites of a body: at its sites instead, as particles are, which
/// points of it may become
template <int Dim>
std::vector<couple::SurfacePoint<Dim>>
surface_points(const PointPlan<Dim>& plan, std::span<const CellOfBody<Dim>> cells, const mpm::PointTerm<Dim>& term,
               const std::function<bool(Index)>& by_sites);

/// Adds a particle in the place of a material point, by the same name, if it lies at the surface of its body.
template <int Dim>
void add_surface_particle(const PointPlan<Dim>& plan, Index body, const Site<Dim>& site, PetscInt row,
                          std::vector<couple::SurfacePoint<Dim>>& points);
} // namespace pdx::scene
