#pragma once
#include "pdx/scene/model.hpp"

namespace pdx::scene {
/// What a condition does to the rows it chooses.
enum class Acts { held, thrown };
constexpr const char* word_of(Acts acts)
{
  return acts == Acts::held ? "displacement or velocity" : "initial velocity";
}

/// A row's share in a side of the body.
struct SideShare {
  Index row = 0;     ///< owned, local
  double area = 0.0; ///< [m^2]
  Vector<3> normal = Vector<3>::Zero();
};

/// Enters boundary conditions into a Model: what is held, thrown in, loaded or pushed, and what drives that in time.
class Prescriptions {
public:
  /// The rows of the model are numbered. @param options, model outlive this
  Prescriptions(const options::SceneOptions& options, Model& model);

  /// All conditions, in order: later ones win where something is held, and the reaction is theirs.
  /// @param rows_of (condition, Acts) -> std::set<Index> of owned rows
  /// @param add_loads (condition, force of owned components [N]); called where there is a traction or force
  /// @param shares_of (condition) -> std::vector<SideShare>; called where there are springs
  /// @param half_size (owned row) -> how far the body goes beyond its place [m]; called where there is a pin
  template <class RowsOf, class AddLoads, class SharesOf, class HalfSize>
  void enter(RowsOf&& rows_of, AddLoads&& add_loads, SharesOf&& shares_of, HalfSize&& half_size)
  {
    std::vector<double> force;
    for (const options::BoundaryCondition& c : options_.conditions) {
      if (c.holds()) hold(c, rows_of(c, Acts::held));
      if (c.initial_velocity) throw_in(c, rows_of(c, Acts::thrown));
      if (c.springs) spring(c, shares_of(c));
      if (c.pin) {
        std::vector<double> sizes;
        for (Index row = 0; row < model_.system.rows.owned(); ++row) sizes.push_back(half_size(row));
        pin(c, std::move(sizes));
      }
      if (!c.traction && !c.body && !c.force) continue;
      force.assign(static_cast<std::size_t>(model_.system.rows.owned() * dim_), 0.0);
      add_loads(c, force);
      load(c, force);
    }
    finish();
  }

private:
  struct Held {
    double value = 0.0; ///< [m] or [m/s]; of what turns along itself [m]
    std::size_t condition = 0;
    field::Drive::Kind kind = field::Drive::Kind::displacement;
    double across = 0.0; ///< of what turns [m]
  };
  struct Rolled {
    Vector<3> along = Vector<3>::Zero();
    std::size_t condition = 0;
  };
  void hold(const options::BoundaryCondition& c, const std::set<Index>& rows);
  std::optional<Held> held_by(const options::BoundaryCondition& c, Index row, Index axis) const;
  void throw_in(const options::BoundaryCondition& c, const std::set<Index>& rows);
  void load(const options::BoundaryCondition& c, std::span<const double> force);
  void spring(const options::BoundaryCondition& c, const std::vector<SideShare>& shares);
  void pin(const options::BoundaryCondition& c, std::vector<double> half_sizes);
  void settle_rollers();
  std::optional<std::size_t> settle_rollers(Index row, const std::vector<Rolled>& all);
  void finish();
  bool is_set(Index row) const;

  const options::SceneOptions& options_;
  Model& model_;
  Index dim_;
  std::map<Index, Held> values_;                // per held component
  std::map<Index, std::vector<Rolled>> rolled_; // per row
};
} // namespace pdx::scene
