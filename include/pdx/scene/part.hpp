#pragma once
#include "pdx/field/output_field.hpp"
#include "pdx/field/row_name.hpp"
#include "pdx/field/term.hpp"
#include "pdx/io/curve.hpp"
#include "pdx/options/scene_options.hpp"
#include "pdx/post/energy_ledger.hpp"
#include "pdx/track/crack_tree.hpp"

#include <functional>
#include <map>
#include <optional>

namespace pdx::scene {
/// What of the work of all passes so far was done and what was skipped, this rank: tiles of bonds in lane strips, or
/// cells of points.
struct Tiles {
  std::int64_t computed = 0, skipped = 0;
  Tiles& operator+=(const Tiles& more)
  {
    computed += more.computed;
    skipped += more.skipped;
    return *this;
  }
};

/// A moment of a scene, to be pictured.
struct Picture {
  const options::SceneOptions& options;
  std::span<const double> local;            ///< displacement [owned | halo] [m]
  std::span<const double> velocity;         ///< of owned components; 0 in statics [m/s]
  std::span<const double> relative_percent; ///< [XPD1 Eq. 28] per owned vertex; of use where a reference is asked for
};

/// Bonds of a state that broke, on their way to a part that may have other ranks and another layout.
struct BrokenBonds {
  MPI_Comm comm = MPI_COMM_NULL;
  int width = 0;                         ///< words of a particle
  std::vector<std::uint64_t> mine;       ///< gone words of the part's own particles, but of those that stay
  std::vector<field::RowName> torn;      ///< particles of the state that lost bonds, this rank's share
  std::vector<std::uint64_t> torn_words; ///< of each of them
  const std::vector<std::uint64_t>* carried = nullptr; ///< keys that broke, of all ranks, ascending; null for none
  bool changed = false;                                ///< the state is of another layout of this run

  /// Gone words of any particles. Collective.
  std::vector<std::uint64_t> words_of(std::span<const field::RowName> wanted) const;
};

/// Damage of the particles whose cracks are followed, this rank's.
struct Watched {
  std::vector<double> damage;                     ///< precrack included [-]
  std::function<std::uint64_t(std::size_t)> name; ///< of the site of each (`track::TreeGround::names`)
};

/// A particle on a lattice in the plane, as one looks for sections that broke through.
struct SeenParticle {
  Index body = 0;
  std::int64_t lattice = 0;
  std::array<std::int64_t, 2> number{}; ///< of its site, in a lattice of all the body
  double damage = 0.0, precrack = 0.0;  ///< [-]
  Vector<2> at;                         ///< [m]
  double spacing = 0.0;                 ///< [m]
};

/// One of the kinds of things that a scene may be made of: the mesh and its elements, particles, points. All that is
/// asked of a scene from outside is asked of its parts, in their order; what a part does not have it leaves out.
class Part {
public:
  Part() = default;
  virtual ~Part() = default;
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  /// Adds the names of the rows that it has, in their order.
  virtual void add_names(std::vector<field::RowName>&) const {}
  /// The name of one of its rows, RowName() for a row of another part. Of parts in the plane.
  virtual field::RowName row_name(Index) const { return {}; }
  /// Adds where its particles are counted from in files, patch by patch, and where the last of them ends.
  virtual void add_numbers(std::vector<PetscInt>&) const {}

  /// Strain energies at local blocks u, this rank's [J]. Collective.
  virtual void add_energies(std::span<const double> local, post::Energies& mine) const = 0;
  /// Are its energies those of material points, with columns of their own?
  virtual bool is_of_points() const { return false; }
  /// Its kinetic energy, where nodes are those of elements too; else 0, this rank's [J].
  virtual double own_kinetic(std::span<const double>) const { return 0.0; }

  /// Fields of what it owns. Collective.
  virtual void add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const = 0;

  /// What history.csv says of it besides. @param velocity of owned components [m/s]   The last is collective.
  ///@{
  virtual void add_columns(std::vector<io::Column>&) const {}
  virtual void add_row(std::span<const double>, std::span<const double>, std::vector<double>&) const {}
  ///@}

  /// Lines "name = value" that a checkpoint of the same scene has.
  virtual std::string described() const { return {}; }
  /// What it is, in a line for the report; "" for nothing worth one. Collective.
  virtual std::string counted(const options::SceneOptions&) const { return {}; }
  /// What is odd but allowed, alike on every rank; "" for nothing.
  virtual std::string warning(const options::SceneOptions&) const { return {}; }
  virtual std::optional<Tiles> tiles() const { return std::nullopt; } ///< of bonds
  virtual Tiles cells() const { return {}; }                          ///< of points

  /// Does the work of a Term lie in it?
  virtual bool works_in(const field::Term& term) const = 0;
  /// Adds the share of each owned cell of the mesh in that work, in any unit.
  virtual void add_shares(std::vector<double>& cells) const = 0;

  /// What broke, by names: so many words for each of its particles, and keys of carried bonds.
  ///@{
  virtual int words_per_particle() const { return 0; } ///< 0 without bonds
  virtual std::vector<std::uint64_t> gone() const { return {}; }
  virtual bool carries_bonds() const { return false; }
  virtual std::vector<std::uint64_t> broken_carried() const { return {}; } ///< this rank's
  virtual void break_bonds(const BrokenBonds&) {}                          ///< Collective.
  virtual void add_torn(BrokenBonds&) const {} ///< of particles that stayed as they were when the layout changed
  ///@}

  /// Where its cracks can be followed, as the scene was given; none where they cannot.
  virtual std::vector<track::TreeGround> grounds(const options::SceneOptions&) const { return {}; }
  virtual bool watches(std::size_t) const { return true; } ///< owned particle k, of those
  virtual Watched watched() const { return {}; }           ///< Collective.
  /// The same damage of some owned particles.
  virtual std::vector<double> damage_of(std::span<const std::size_t> particles) const
  {
    const Watched all = watched();
    std::vector<double> some;
    for (const std::size_t k : particles) some.push_back(all.damage[k]);
    return some;
  }
  virtual std::vector<SeenParticle> seen() const { return {}; } ///< Collective.
  /// Counts the sites of a body's lattice that are particles or may become so, by their number along an axis, this
  /// rank's. Collective.
  virtual void count_sites(Index, std::int64_t, std::size_t, std::map<std::int64_t, std::int64_t>&) const {}
};
} // namespace pdx::scene
