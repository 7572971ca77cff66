#pragma once
#include "pdx/base/error.hpp"
#include "pdx/base/tensor.hpp"

#include <petscdm.h>
#include <petscsection.h>
#include <petscsf.h>
#include <petscsnes.h>
#include <type_traits>
#include <utility>

namespace pdx {
static_assert(std::is_same_v<PetscInt, Index>, "pdxsolve needs a PETSc built with 32-bit indices");
static_assert(std::is_same_v<PetscScalar, double>, "pdxsolve needs a PETSc built for real double precision");

/// Throws PetscFailure for a non-zero code; the message of PETSc's own error, where there is one, comes first.
void check(PetscErrorCode code, const char* call, const char* file, int line);

/// The first message PETSc's error handler received since the last call of this function ("" if none).
std::string take_petsc_message();
/// Replaces PETSc's printing error handler by one that remembers the deepest message and prints nothing.
void install_quiet_error_handler();

/// Runs the body of a C callback given to PETSc: no exception unwinds through PETSc's frames.
/// The exception is kept and thrown again by `check` once PETSc has returned to us.
void keep_exception() noexcept;
template <class Body> PetscErrorCode guard(Body&& body) noexcept
{
  try {
    body();
    return 0;
  } catch (...) {
    keep_exception();
    return PETSC_ERR_LIB;
  }
}

/// Sole owner of one PETSc reference; moves, never copies; quiet after PetscFinalize.
template <class T, PetscErrorCode (*destroy)(T*)> class Handle {
public:
  Handle() = default;
  Handle(Handle&& other) noexcept : raw_(std::exchange(other.raw_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept
  {
    std::swap(raw_, other.raw_);
    return *this;
  }
  ~Handle() { reset(); }
  T get() const noexcept { return raw_; } ///< lends; ownership stays here
  T* out()                                ///< for XCreate(..., handle.out())
  {
    reset();
    return &raw_;
  }
  T* address() noexcept { return &raw_; }     ///< for calls that change the object in place
  void abandon() noexcept { raw_ = nullptr; } ///< for what is in no state to be destroyed
  explicit operator bool() const noexcept { return raw_ != nullptr; }
  void reset() noexcept
  {
    PetscBool over = PETSC_FALSE;
    if (raw_ && !PetscFinalized(&over) && !over) (void)destroy(&raw_);
    raw_ = nullptr;
  }

private:
  T raw_ = nullptr;
};
using VecHandle = Handle<Vec, VecDestroy>;
using MatHandle = Handle<Mat, MatDestroy>;
using KspHandle = Handle<KSP, KSPDestroy>;
using SnesHandle = Handle<SNES, SNESDestroy>;
using DmHandle = Handle<DM, DMDestroy>;
using SfHandle = Handle<PetscSF, PetscSFDestroy>;
using SectionHandle = Handle<PetscSection, PetscSectionDestroy>;
using NullSpaceHandle = Handle<MatNullSpace, MatNullSpaceDestroy>;
} // namespace pdx
/// Wraps every PETSc call made from C++. (std::source_location would lock out clang-tidy 14.)
#define PDX_CALL(...) ::pdx::check((__VA_ARGS__), #__VA_ARGS__, __FILE__, __LINE__)
