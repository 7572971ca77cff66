#pragma once
#include "pdx/field/system.hpp"
#include "pdx/field/tie.hpp"
#include "pdx/io/curve.hpp"

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace pdx::couple {
class ContactBooks;
}

namespace pdx::scene {
inline constexpr const char* kAxes[] = {"x", "y", "z"};

/// Which body each owned row of a scene moves.
struct BodyRows {
  std::vector<std::string> names; ///< of the bodies
  std::vector<Index> of_row;      ///< place in `names`, per owned row
};

/// Momentum, angular momentum and mean velocity of the bodies of a scene, and what they do to each other where they
/// touch: as history.csv and the results tell them. All but `more_columns` and `kinetic` are collective.
class BodyLedger {
public:
  virtual ~BodyLedger() = default;
  virtual std::vector<io::Column> more_columns() const = 0;
  /// @param local displacement, with its halo [m]   @param velocity of owned components [m/s]
  virtual void add_more(std::span<const double> local, std::span<const double> velocity,
                        std::vector<double>& row) const = 0;
  /// `momentum_error_ratio` of bodies that nothing holds or loads, `rebound_ratio` of two that met.
  virtual void add_results(std::span<const double> local, std::span<const double> velocity,
                           nlohmann::ordered_json& results) const = 0;
  /// 1/2 m v^2 of the first `rows` rows of bodies before `end`, this rank's part [J].
  virtual double kinetic(std::span<const double> velocity, Index rows, Index end) const = 0;
  /// What the run began with, whose layout may have been another: mass [kg] and momentum [kg m/s] of each body, centre
  /// of mass of all [m]; and the way back. Alike on all ranks.
  ///@{
  virtual std::vector<double> start() const = 0;
  virtual void begin_with(std::span<const double> start) = 0;
  ///@}
};

template <int Dim> class BodyBooks final : public BodyLedger {
public:
  /// @param system bound, with its initial velocity; outlives this
  /// @param contact null where nothing touches; outlives this
  BodyBooks(const field::System& system, BodyRows rows, const couple::ContactBooks* contact);

  std::vector<io::Column> more_columns() const override;
  void add_more(std::span<const double> local, std::span<const double> velocity,
                std::vector<double>& row) const override;
  void add_results(std::span<const double> local, std::span<const double> velocity,
                   nlohmann::ordered_json& results) const override;
  double kinetic(std::span<const double> velocity, Index rows, Index end) const override;
  std::vector<double> start() const override;
  void begin_with(std::span<const double> start) override;

private:
  struct Sums {
    std::vector<double> mass;              ///< of each body [kg]
    std::vector<Vector<Dim>> momentum;     ///< likewise [kg m/s]
    Vector<Dim> moment;                    ///< mass by place, of all [kg m]
    Vector<3> angular = Vector<3>::Zero(); ///< about `middle_` [kg m^2/s]
  };
  Sums sums(std::span<const double> local, std::span<const double> velocity) const;
  /// Of a row, the far half's of an enriched set.
  Vector<Dim> value(std::span<const double> values, std::size_t row) const;

  const field::System& system_;
  BodyRows rows_;
  const couple::ContactBooks* contact_;
  std::vector<double> mass_;                 // of owned rows [kg]
  std::vector<field::Tie> ties_;             // by set
  Vector<Dim> middle_ = Vector<Dim>::Zero(); // centre of mass of all at the start [m]
  Sums start_;
};
} // namespace pdx::scene
