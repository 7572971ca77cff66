#pragma once
#include "pdx/couple/contact_term.hpp"
#include "pdx/field/after_step.hpp"

#include <string>

namespace pdx::couple {
/// What contact does from step to step, in the plane or in space: impulses between bodies, what friction takes.
class ContactBooks : public field::AfterStep {
public:
  /// Names of two bodies that may touch, in the order of `ContactLaw::pairs`.
  struct Pair {
    std::string first, second;
  };
  const std::vector<Pair>& pairs() const { return pairs_; }
  /// On the first body of a pair by the second at the last force, this rank's part [N].
  virtual std::array<double, 3> force(std::size_t pair) const = 0;
  /// Its integral since the start, by the trapezoidal rule: what steps by central differences hand over [N s].
  const std::array<double, 3>& impulse(std::size_t pair) const { return now_.impulse[pair]; }
  /// As those of ContactTerm, in the order of `pairs`, of what this rank sees [-].
  ///@{
  virtual std::span<const double> depths() const = 0;
  virtual std::span<const double> approaches() const = 0;
  ///@}
  double dissipated() const override { return now_.friction; } ///< by friction

  /// This rank's part of all sums: one number of friction, then 6 of each pair.
  std::vector<double> sums() const;
  /// Goes on from there. Ranks may be others, if all sums are added up.
  void resume(std::span<const double> sums);

protected:
  explicit ContactBooks(std::vector<Pair> pairs);
  struct Sums {
    std::vector<std::array<double, 3>> force, impulse; // per pair; force at the end of the last step
    double friction = 0.0;
  };
  std::vector<Pair> pairs_;
  Sums now_, saved_;
};

/// Keeps the books of a ContactTerm.
template <int Dim> class ContactStep final : public ContactBooks {
public:
  explicit ContactStep(ContactTerm<Dim>& contact); ///< must outlive this

  std::array<double, 3> force(std::size_t pair) const override;
  std::span<const double> depths() const override { return contact_.depths(); }
  std::span<const double> approaches() const override { return contact_.approaches(); }
  void stepped(double length) override;
  void apply(std::span<const double> u, field::ForceLosses& losses) override;
  void save() override;
  void restore() override;

private:
  ContactTerm<Dim>& contact_;
};
} // namespace pdx::couple
