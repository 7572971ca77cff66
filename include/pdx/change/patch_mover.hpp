#pragma once
#include "pdx/adapt/contraction.hpp"
#include "pdx/adapt/conversion.hpp"
#include "pdx/adapt/expansion.hpp"
#include "pdx/adapt/quiet.hpp"
#include "pdx/adapt/seen_damage.hpp"
#include "pdx/adapt/space_conversion.hpp"
#include "pdx/io/hdf5_file.hpp"
#include "pdx/io/sealed_reader.hpp"
#include "pdx/scene/patches.hpp"

namespace pdx::change {

/// Says when patches move and where to, as the options ask for it. All methods are collective.
class PatchMover {
public:
  explicit PatchMover(const options::SceneOptions& options) : options_(options) {}

  bool follows() const { return options_.layout.adapt != options::Adapt::none; }
  bool renews() const { return options_.layout.renew_box.has_value(); }
  adapt::LayoutChange renewal(const adapt::SceneView& scene) const; ///< where it renews
  /// At the start: throws UserError for lengths that cannot work, and returns what is odd, "" for nothing.
  std::string begin(const adapt::SceneView& scene, const scene::PatchPlan& plan) const;
  /// Where bonds broke since the last call, and where bulk bears more than the triggers say.
  /// @param broken bonds that this rank counts, since the start   @param local displacement [owned | halo] [m]
  adapt::LayoutChange look(const adapt::SceneView& scene, const scene::PatchPlan& plan, std::int64_t broken,
                           std::span<const double> local);
  /// The same in space.
  ///@{
  std::string begin(const adapt::SpaceView& scene) const;
  adapt::LayoutChange look(const adapt::SpaceView& scene, std::int64_t broken, std::span<const double> local);
  ///@}
  /// Another scene stands.
  void leave_scene()
  {
    watch_.reset();
    space_watch_.reset();
    seen_.leave_scene();
  }
  /// So it does, and cells may be dealt out anew for it: what ranks have seen of theirs, all know.
  void deal_out(MPI_Comm comm)
  {
    if (!follows()) return;
    seen_.share(comm);
    quiet_.share(comm);
  }
  /// Is the border of patches that stay as they are to be watched still?
  bool watches() const;
  /// Where a crack came within a horizon of elements, which do not break, in words; "" for nowhere. Watches no more
  /// then. Throws SolverFailure where the options say so. @param broken bonds that this rank counts, since the start
  std::string border(const adapt::SceneView& scene, const scene::PatchPlan& plan, std::int64_t broken);
  /// Is it time for patches to hand back what lies behind? Alike on every rank.
  bool may_contract() const
  {
    return options_.layout.adapt == options::Adapt::relocate && expansions_ >= options_.layout.expansions;
  }
  /// What they hand back then.
  adapt::LayoutChange contract(const adapt::SceneView& scene, const scene::PatchPlan& plan,
                               const adapt::MayHandBack& may);

  /// Is it time to look for particles of converted bulk that have been quiet?
  bool may_hand_back(int step) const { return options_.layout.hand_back > 0 && step % quiet_every() == 0; }
  /// What of them becomes bulk again.
  adapt::LayoutChange quiet(const adapt::SceneView& scene, std::span<const double> local);

  /// What it goes on from, as tables of a checkpoint. Throws UserError for tables that make none.
  void write(io::Hdf5File& file) const;
  void read(const io::SealedReader& file);

private:
  int quiet_every() const; ///< steps
  template <int Dim> adapt::ConversionRule conversion_rule() const;
  adapt::BulkWatch bulk_watch(const adapt::SceneView& scene) const;
  std::vector<adapt::LayoutChange::Cover> converted(const adapt::SceneView& scene, std::span<const double> local);
  std::vector<adapt::Reaches> reaches(const adapt::SceneView& scene, const scene::PatchPlan& plan) const;
  adapt::Reaches reaches(const couple::Surroundings& around, double horizon) const;

  bool broke_more(MPI_Comm comm, std::int64_t broken); ///< on any rank, since the last call

  const options::SceneOptions& options_;
  std::int64_t broken_ = 0; // at the last look, this rank
  adapt::SeenDamage seen_;
  adapt::QuietCells quiet_;
  int expansions_ = 0; // since the last contraction
  bool told_ = false;  // what came to the border
  std::vector<geom::LatticeAnchor> lattices_;
  std::optional<adapt::BulkWatch> watch_;        // of the scene as it stands; none: not looked at yet
  std::optional<adapt::SpaceWatch> space_watch_; // likewise, in space
};
} // namespace pdx::change
