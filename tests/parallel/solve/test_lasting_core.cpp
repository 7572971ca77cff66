// Elements eliminated once for several layouts: a patch that goes along through a plate, column by column.
#include "pdx/scene/scene_names.hpp"
#include "pdx/solve/lasting_core.hpp"
#include "pdx/solve/static_solver.hpp"
#include "support/pulled.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace lasting_test {
constexpr Index kCells = 24, kWidth = 6;

/// A patch of kWidth x kWidth elements that begins at column `from`, in a crack's way or not.
options::SceneOptions patch_at(Index from, bool cracked)
{
  const double h = 1.0 / kCells, left = static_cast<double>(from) * h;
  options::SceneOptions options = test::with_patch(test::held_plate({kCells, kCells}),
                                                   {{left, 9 * h}, {left + kWidth * h, (9 + kWidth) * h}}, h / 3);
  if (cracked) options.cracks.lines = {{{0.0, 0.51}, {left + 3 * h, 0.51}}};
  options.conditions.resize(1); // left
  options.conditions.push_back(test::pull("right", {1e-2, 2e-2}));
  return options;
}

VecHandle solved(test::Scene& scene, solve::Condense condense, solve::Lasting* lasting)
{
  VecHandle u = scene.rows().vector();
  solve::StaticSolver solver(scene.system(), {.load_steps = 2, .condense = condense}, {}, lasting);
  EXPECT_EQ(solver.condensation().why_not, condense == solve::Condense::on ? "" : "-static_condense off");
  solver.run(u.get(), [](const solve::Step&, Vec) { return solve::Verdict::go_on; });
  return u;
}

/// Layouts of which the core was that of the one before.
int stood(bool cracked, Index first, Index last)
{
  solve::Lasting lasting;
  int stood = 0;
  for (Index from = first; from <= last; ++from) {
    test::Scene scene(patch_at(from, cracked));
    const scene::Standing standing{nullptr, &scene.d()};
    const scene::SceneNames names(standing);
    lasting.names.assign(names.rows().begin(), names.rows().end());
    const std::shared_ptr<solve::LastingCore> before = lasting.core;
    VecHandle u = solved(scene, solve::Condense::on, &lasting);
    const VecHandle whole = solved(scene, solve::Condense::off, nullptr);
    EXPECT_LT(test::difference(u.get(), whole.get(), NORM_INFINITY), 1e-8) << "patch from column " << from;
    stood += scene.max(lasting.core && lasting.core == before ? 1.0 : 0.0) > 0.0; // the first rank has it
  }
  return stood;
}
} // namespace lasting_test
using namespace lasting_test;

TEST(LastingCore, StandsWhileAPatchGoesAlong)
{
  EXPECT_GE(stood(false, 5, 9), 3); // the first is all there was, the second knows the way
}

TEST(LastingCore, StandsWhereTheCrackBehindItIsCut) { EXPECT_GE(stood(true, 5, 8), 2); }

TEST(LastingCore, IsMadeAnewWhereWhatItHoldsChanges)
{
  solve::Lasting lasting;
  for (const double young : {1.0, 2.0}) { // the same rows, another stiffness
    options::SceneOptions options = patch_at(6, false);
    options.elastic.young *= young;
    test::Scene scene(std::move(options));
    const scene::Standing standing{nullptr, &scene.d()};
    const scene::SceneNames names(standing);
    lasting.names.assign(names.rows().begin(), names.rows().end());
    VecHandle u = solved(scene, solve::Condense::on, &lasting);
    const VecHandle whole = solved(scene, solve::Condense::off, nullptr);
    EXPECT_LT(test::difference(u.get(), whole.get(), NORM_INFINITY), 1e-8);
  }
}
