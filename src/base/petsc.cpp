#include "pdx/base/petsc.hpp"

#include "pdx/base/machine_failure.hpp"
#include "pdx/base/memory.hpp"
#include "pdx/base/petsc_names.hpp"

#include <exception>

namespace pdx {
namespace {
std::string first_message;
std::exception_ptr kept;

PetscErrorCode remember(MPI_Comm, int, const char* function, const char*, PetscErrorCode code, PetscErrorType type,
                        const char* message, void*)
{
  if (type == PETSC_ERROR_INITIAL && first_message.empty())
    first_message = std::string(function ? function : "PETSc") + ": " + (message ? message : "unknown error");
  return code;
}

/// What MUMPS, hypre and others say in PETSc's errors of other kinds.
bool is_of_memory(const std::string& message)
{
  return message.starts_with("PetscMalloc") || message.starts_with("PetscRealloc") ||
         message.find("allocate required memory") != std::string::npos ||
         message.find("ut of memory") != std::string::npos;
}
} // namespace

std::string take_petsc_message() { return std::exchange(first_message, {}); }

void install_quiet_error_handler() { PDX_CALL(PetscPushErrorHandler(remember, nullptr)); }

void keep_exception() noexcept
{
  if (!kept) kept = std::current_exception();
}

void check(PetscErrorCode code, const char* call, const char* file, int line)
{
  if (!code) [[likely]]
    return;
  if (kept) {
    (void)take_petsc_message();
    std::rethrow_exception(std::exchange(kept, nullptr));
  }
  std::string message = take_petsc_message();
  for (char& c : message)
    if (c == '\n') c = ' ';
  if (code == PETSC_ERR_MEM || is_of_memory(message)) throw MachineFailure(memory_ran_out());
  const char* name = nullptr;
  if (message.empty() && !PetscErrorMessage(code, &name, nullptr) && name) message = name;
  if (code == PETSC_ERR_ARG_UNKNOWN_TYPE || message.starts_with("PetscOptions"))
    throw UserError(message + std::string(kPetscValue));
  throw PetscFailure(message + " [" + file + ":" + std::to_string(line) + ": " + call + "]");
}
} // namespace pdx
