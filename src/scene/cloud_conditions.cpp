#include "pdx/base/gather.hpp"
#include "pdx/scene/cloud_body.hpp"
#include "pdx/scene/prescriptions.hpp"

#include <fmt/format.h>

namespace pdx::scene {
namespace {
template <int Dim> class CloudConditions {
public:
  CloudConditions(const options::SceneOptions& options, const pd::Cloud<Dim>& cloud, const pd::CloudTerm<Dim>& bonds,
                  Model& body)
      : options_(options), cloud_(cloud), bonds_(bonds), body_(body)
  {}

  void apply()
  {
    const auto rows = [&](const options::BoundaryCondition& c, Acts acts) { return rows_of(c, word_of(acts)); };
    Prescriptions(options_, body_)
        .enter(
            rows,
            [&](const options::BoundaryCondition& c, std::span<double> force) {
              if (c.body) add(rows_of(c, "body force"), *c.body, force);
              if (c.force) add(rows_of(c, "force"), *c.force / chosen_volume(c), force);
            },
            [](const options::BoundaryCondition&) { return std::vector<SideShare>(); },
            [&](Index row) {
              return 0.5 * pd::particle_size<Dim>(bonds_.volumes()[static_cast<std::size_t>(row)],
                                                  options_.elastic.thickness);
            });
  }

private:
  bool chosen(const options::BoundaryCondition& c, std::size_t number) const
  {
    if (c.box && !c.box->contains(cloud_.points[number].template head<2>(), 1e-6 * options_.pd.horizon)) return false;
    return !c.set || *c.set == cloud_.sets[number];
  }

  std::set<Index> rows_of(const options::BoundaryCondition& c, const char* what) const
  {
    std::set<Index> rows;
    for (std::size_t k = 0; k < body_.particles.size(); ++k)
      if (chosen(c, static_cast<std::size_t>(body_.particles[k].site))) rows.insert(static_cast<Index>(k));
    if (any_rank(body_.system.rows.comm, !rows.empty())) return rows;
    if (c.set && !c.box)
      throw UserError(fmt::format("-bc_{}_set is {}: no particle has it for the {} to act on", c.name, *c.set, what));
    throw UserError(fmt::format("-bc_{}_box: no particle {}lies there for the {} to act on", c.name,
                                c.set ? fmt::format("of the set {} ", *c.set) : "", what));
  }

  void add(const std::set<Index>& rows, const Vector<3>& density, std::span<double> force) const
  {
    for (const Index row : rows)
      for (Index a = 0; a < Dim; ++a)
        force[static_cast<std::size_t>(Dim * row + a)] += bonds_.volumes()[static_cast<std::size_t>(row)] * density[a];
  }

  /// On all ranks, summed in the order of the file, so that nothing depends on their number [m^3].
  double chosen_volume(const options::BoundaryCondition& c) const
  {
    double volume = 0.0;
    for (std::size_t number = 0; number < cloud_.points.size(); ++number)
      if (chosen(c, number)) volume += cloud_.volumes[number];
    return volume;
  }

  const options::SceneOptions& options_;
  const pd::Cloud<Dim>& cloud_;
  const pd::CloudTerm<Dim>& bonds_;
  Model& body_;
};

} // namespace

template <int Dim>
void apply_conditions(const options::SceneOptions& options, const pd::Cloud<Dim>& cloud,
                      const pd::CloudTerm<Dim>& bonds, Model& model)
{
  CloudConditions<Dim>(options, cloud, bonds, model).apply();
}
template void apply_conditions<2>(const options::SceneOptions&, const pd::Cloud<2>&, const pd::CloudTerm<2>&, Model&);
template void apply_conditions<3>(const options::SceneOptions&, const pd::Cloud<3>&, const pd::CloudTerm<3>&, Model&);

} // namespace pdx::scene
