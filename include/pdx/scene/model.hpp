#pragma once
#include "pdx/couple/fracture.hpp"
#include "pdx/couple/step_breaker.hpp"
#include "pdx/field/system.hpp"
#include "pdx/pd/particles.hpp"
#include "pdx/pd/region_factors.hpp"
#include "pdx/scene/body_books.hpp"
#include "pdx/scene/part.hpp"
#include "pdx/xfem/enriched_sets.hpp"

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>

namespace pdx::scene {
/// Components a boundary condition holds, for its reaction force.
struct HeldPart {
  std::string name;
  std::vector<Index> components;   ///< owned, local
  std::optional<Vector<2>> centre; ///< that it turns about [m]
};

/// Springs or a pin, as a condition calls them.
struct NamedSupport {
  std::string name;
  const field::Support* term = nullptr; ///< borrowed from system.terms
};

/// Where friction holds points, of all ranks, by names that are alike on any number of them: `couple::NamedGrip`.
struct NamedGrips {
  std::vector<std::uint64_t> names; ///< of each: the point, the body of the skin, the points of the facet
  std::vector<double> numbers;      ///< of each: the weights of these, and the stretch [m]
};

/// What bodies that touch keep besides the state of rows.
class Touching {
public:
  virtual ~Touching() = default;
  virtual void add_energies(std::span<const double> local, post::Energies& mine) const = 0; ///< [J]
  virtual const couple::ContactBooks* books() const = 0;
  /// Sums since the start, this rank's part, and the way back: ranks may be others, if all are added up.
  ///@{
  virtual std::vector<double> sums() const = 0;
  virtual void resume(std::span<const double> sums) = 0;
  ///@}
  virtual std::optional<NamedGrips> grips() const = 0; ///< none where nothing rubs; collective
  virtual void hold(const NamedGrips& grips) = 0;      ///< points that are not here any more are let go
};

/// A scene with its rows, Terms and conditions, in the plane or in space: all that stepping through time and recording
/// ask of it, whatever parts it is made of.
struct Model {
  Model() = default;
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  crack::CrackSet cracks;
  geom::Box<2> body; ///< in the plane, that the cracks are in [m]
  field::System system;
  std::vector<std::unique_ptr<Part>> parts; ///< in order of their rows
  std::vector<pd::Particle> particles;      ///< owned, in order of rows
  couple::BondBreaker* breaker = nullptr; ///< borrowed from system.after_step; null in statics or if nothing can break
  couple::Fracture* fracture = nullptr;   ///< borrowed from system.after; null in time or if nothing can break
  std::vector<double> critical_stretch;   ///< per patch [-]; empty if nothing can break
  std::vector<HeldPart> held_parts;
  std::vector<NamedSupport> supports;   ///< what pushes from outside by a stiffness of its own
  const xfem::CutReport* cut = nullptr; ///< what cracks did to elements; null where there are none
  Index ghosts = 0;                     ///< on all ranks [-]
  std::int64_t material_points = 0;     ///< likewise
  std::unique_ptr<BodyLedger> bodies;   ///< null where bodies are not told apart
  std::unique_ptr<Touching> touching;   ///< null where nothing touches

  bool breaks() const { return breaker || fracture; }
  bool has_points() const; ///< some part is of material points
  bool has_others() const; ///< some part is not

  /// This rank's strain energies at local blocks u [J]. Collective.
  post::Energies energies(std::span<const double> local) const;
  double kinetic_of_points(std::span<const double> velocity) const; ///< as `Part::own_kinetic`, of all parts
  std::optional<Tiles> tiles() const;                               ///< of all parts; none where no part has them
  Tiles cells_of_points() const;                                    ///< likewise
  std::vector<field::OutputBlock> blocks(const Picture& now) const; ///< Collective.
  std::string described() const;

  /// What history.csv says of it besides. @param velocity of owned components [m/s]   The last is collective.
  ///@{
  std::vector<io::Column> more_columns() const;
  void add_more(std::span<const double> local, std::span<const double> velocity, std::vector<double>& row) const;
  ///@}

  /// What of the sums since the start is this scene's: `Touching::sums`.
  ///@{
  std::vector<double> rank_sums() const { return touching ? touching->sums() : std::vector<double>{}; }
  void resume_sums(std::span<const double> sums) const
  {
    if (touching) touching->resume(sums);
  }
  ///@}
};

/// The cracks that are there from the start. Throws UserError for one that is nowhere in the body.
crack::CrackSet cracks_in(const options::SceneOptions& options, const geom::Box<2>& body);

/// Throws UserError for a zone without failure that is nowhere in the body.
void judge_no_fail(const options::SceneOptions& options, const geom::Box<2>& body);

/// Critical stretch of the bonds of a stencil, by toughness or as given [-].
template <int Dim> double critical_stretch(const options::SceneOptions& options, const pd::Stencil<Dim>& stencil);

/// With the bonds of other materials, where there are regions.
template <int Dim>
pd::SurfaceCorrection<Dim> in_regions(const options::SceneOptions& options, const pd::Stencil<Dim>& stencil,
                                      pd::SurfaceCorrection<Dim> surfaces)
{
  if (!options.regions || options.regions->one_elastic()) return surfaces;
  return pd::correct_regions<Dim>(stencil, options.regions, std::move(surfaces));
}
} // namespace pdx::scene
