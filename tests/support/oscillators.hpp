#pragma once
#include "pdx/solve/time_driver.hpp"
#include "support/inert_term.hpp"
#include "support/ranks.hpp"
#include "support/springs.hpp"

#include <memory>
#include <string>

namespace pdx::test {
/// Masses on springs to the ground, and the options of a run; the last are taken back at the end.
struct Oscillators {
  using Given = std::vector<std::pair<const char*, std::string>>;
  explicit Oscillators(Given given, Index rows = 1) : options(std::move(given))
  {
    std::vector<Spring> list;
    for (Index row = 0; row < rows; ++row)
      for (const std::array<double, 2> along : {std::array{1.0, 0.0}, std::array{0.0, 1.0}})
        list.push_back({row, along, kStiffness, kUnbreakable});
    bed = std::make_unique<SpringBed>(rows, std::array{0.0, 0.0}, list);
    bed->system.terms.push_back(std::make_unique<Masses>(rows));
    for (const auto& [name, value] : options) PDX_CALL(PetscOptionsSetValue(nullptr, name, value.c_str()));
  }
  ~Oscillators()
  {
    for (const auto& option : options) PDX_CALL(PetscOptionsClearValue(nullptr, option.first));
  }
  field::System& system() { return bed->system; }
  /// 1/2 k u.u of all ranks.
  double stored(const solve::TimeDriver& driver) const
  {
    double mine = 0.0;
    for (const double u : driver.u()) mine += 0.5 * kStiffness * u * u;
    return sum(mine);
  }
  double work(const solve::TimeDriver& driver) const { return sum(driver.moving().work()); }

  class Masses final : public InertTerm {
  public:
    explicit Masses(Index rows) : rows_(rows) {}
    void add_mass(std::span<double> mass) const override
    {
      for (Index row = 0; row < rows_; ++row) mass[static_cast<std::size_t>(row)] += kMass;
    }

  private:
    Index rows_;
  };
  static constexpr double kStiffness = 9.0, kMass = 4.0, kOmega = 1.5, kLimit = 2.0 / kOmega;
  std::vector<std::pair<const char*, std::string>> options;
  std::unique_ptr<SpringBed> bed;
};
} // namespace pdx::test
