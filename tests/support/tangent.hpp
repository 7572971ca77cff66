#pragma once
#include "pdx/field/term.hpp"

#include <vector>

namespace pdx::test {
/// The tangent of some terms as an AIJ matrix; adding outside of the announced couplings is an error. Collective.
/// @param held one per component of [owned | halo]   @param u where it is taken, [owned | halo] [m]
/// @param diagonal of the held components
inline MatHandle tangent_of(const std::vector<field::Term*>& terms, const field::RowHalo& halo,
                            std::span<const std::uint8_t> held, std::span<const double> u, double diagonal)
{
  const field::Rows& rows = halo.rows();
  field::Couplings couplings(halo);
  for (const field::Term* term : terms) term->couplings(couplings, true);
  MatHandle k;
  PDX_CALL(MatCreate(rows.comm, k.out()));
  const PetscInt size = rows.dim * rows.owned();
  PDX_CALL(MatSetSizes(k.get(), size, size, PETSC_DETERMINE, PETSC_DETERMINE));
  PDX_CALL(MatSetType(k.get(), MATAIJ));
  PDX_CALL(MatSetBlockSize(k.get(), rows.dim));
  PDX_CALL(MatXAIJSetPreallocation(k.get(), rows.dim, couplings.diagonal.data(), couplings.off_diagonal.data(), nullptr,
                                   nullptr));
  PDX_CALL(MatSetOption(k.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_TRUE));
  field::BlockAdder adder(k.get(), halo, held);
  for (field::Term* term : terms) {
    term->linearise(u);
    term->add_jacobian(adder, true);
  }
  adder.finish(diagonal);
  return k;
}
} // namespace pdx::test
