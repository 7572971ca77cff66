#pragma once
#include "pdx/couple/carried_points.hpp"
#include "pdx/couple/contact_grip.hpp"
#include "pdx/couple/contact_list.hpp"
#include "pdx/couple/contact_start.hpp"
#include "pdx/couple/contact_tangent.hpp"
#include "pdx/field/term.hpp"

namespace pdx::couple {
/// A point at the surface of a body, and what carries it.
template <int Dim> struct SurfacePoint {
  SkinPoint<Dim> at;
  Host host; ///< global rows
};

/// A grip by names that are alike on any number of ranks.
template <int Dim> struct NamedGrip {
  std::uint64_t point = 0, body = 0;
  std::array<std::uint64_t, Dim> points{};
  std::array<double, Dim> weights{};
  double stretch = 0.0; ///< [m]
};

/// Contact between bodies by penalty on carried points, see ContactLaw, and in explicit steps Coulomb friction. Every
/// rank that moves a surface point of a body that may touch another has the rows of all such points in its halo, so
/// that nothing but the halo of u travels: forces are evaluated on each rank whose rows they act on, by the same
/// arithmetic. Near points are looked for where any has moved by more than the list allows; each rank looks when it has
/// to, as the list does not change the forces.
template <int Dim> class ContactTerm final : public field::Term {
public:
  /// @param mine surface points of this rank, each given by one rank; bodies are numbered as in `bodies`
  /// Throws UserError, alike on every rank, for bodies that overlap at displacement 0. Collective.
  ContactTerm(const field::Rows& rows, std::span<const SurfacePoint<Dim>> mine, std::vector<ContactBody> bodies,
              ContactOptions options);

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override { linearised_.assign(u.begin(), u.end()); }
  /// Of what is near at displacement 0; `add_jacobian` lets the matrix grow where others come to touch. Both throw
  /// where there is friction, which has no tangent.
  void couplings(field::Couplings& couplings, bool whole) const override;
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  bool symmetric() const override { return law_.options().friction == 0.0; }
  /// Of bodies that just touch, everywhere at their surfaces: at most two others at one point.
  void add_stiffness_bound(std::span<double> blocks) const override;

  const ContactLaw<Dim>& law() const { return law_; }
  Index points() const { return static_cast<Index>(skin_.points().size()); } ///< that this rank knows
  /// Of the last force, this rank's part, one per pair of `law().pairs()`: on the first body by the second [N].
  std::span<const Vector<Dim>> pair_forces() const { return pair_forces_; }
  /// Of all forces so far, what this rank sees, one per pair of `law().pairs()`:
  ///@{
  /// Largest (d0 - d) / d0 [-]. Above 1/4 bodies are about to go through each other, and the bound on the stiffness is
  /// none.
  std::span<const double> depths() const { return depths_; }
  /// By what part of d0 a step brought the bodies nearer to each other, the largest, while they were apart [-].
  std::span<const double> approaches() const { return approaches_; }
  ///@}

  /// Grips become those of the last force. @return what friction took, as this rank counts it [J]
  double slip();
  std::vector<NamedGrip<Dim>> grips() const; ///< that this rank counts
  /// @param grips of all ranks; those of points that are not here any more are let go
  void set_grips(std::span<const NamedGrip<Dim>> grips);
  void save() { saved_ = grips_; } ///< grips
  void restore()
  {
    grips_ = saved_;
    listed_ = false;
  }

private:
  using Near = typename ContactList<Dim>::Near;
  bool counts(Index point) const { return counted_[static_cast<std::size_t>(point)]; }
  void follow(std::span<const double> u) const;
  double moved(std::span<const double> u) const;
  void place(std::span<const double> u, Index point) const;
  void note_approach() const;
  double stiffness(Index point, Index body) const;
  template <class Visit, class LetGo> void for_each_touch(Visit&& visit, LetGo&& let_go) const;
  void push(const Near& near, const Touch<Dim>& touch, double k, const Traction<Dim>* traction) const;
  void let_go(const Grip<Dim>& grip) const;
  void add_tangent(const Near& near, const Touch<Dim>& touch, double k, field::BlockAdder& adder) const;
  double offset(const Near& near) const;

  field::Rows rows_;
  ContactLaw<Dim> law_;
  ContactSkin<Dim> skin_;     // of all ranks; empty where this rank moves no point of it
  CarriedPoints<Dim> points_; // of skin_
  std::vector<StartOffset> offsets_;
  std::vector<std::uint8_t> mine_, counted_; // per point: this rank moves it; counts what it touches
  std::vector<Index> surface_rows_;          // local, ascending
  double largest_weight_ = 1.0;              // sum |w| of a point
  double beyond_ = 0.0;                      // [m]
  std::size_t local_size_ = 0;               // of displacements
  std::vector<double> linearised_;           // displacement of the tangent [m]

  std::vector<Grip<Dim>> grips_, saved_; // ascending by point, then body
  mutable std::vector<Grip<Dim>> next_grips_;
  mutable double slip_work_ = 0.0; // of next_grips_ [J]
  mutable bool listed_ = false;
  mutable ContactList<Dim> list_;
  mutable std::vector<double> listed_at_; // displacement of surface_rows_ at the last search [m]
  mutable std::vector<Vector<Dim>> x_, forces_;
  mutable std::vector<Vector<Dim>> pair_forces_;
  mutable std::vector<double> depths_, approaches_; // per pair
  mutable std::vector<double> gaps_;                // likewise, at the last search [m]
  mutable int forces_since_ = 0;                    // that search
};
} // namespace pdx::couple
