// Runs many scenes in one process, for the fuzzer beside this file: an MPI program starts and stops more slowly than a
// small scene is solved. usage: fuzz_harness LIST FIRST: LIST is a JSON array of command lines, those before number
// FIRST are passed over. Each is read and run as the program does it; standard output has a line of JSON for each:
// its number, exit status, message and seconds. What goes wrong between ranks has status -1.
#include "pdx/app/run.hpp"
#include "pdx/base/petsc.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/options/option_reader.hpp"
#include "pdx/record/last_words.hpp"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

namespace {
using Json = nlohmann::json;

struct Outcome {
  int status = 0; ///< exit status [-]
  std::string message;
};

void clear_options()
{
  while (!pdx::given_options().empty()) {
    const std::string name = pdx::given_options().begin()->first;
    pdx::take_back_option(name);
  }
  PDX_CALL(PetscOptionsClear(nullptr));
}

/// PETSc's own options go where a run looks for them; those that only work before it starts have no effect here.
void read_options(const std::vector<std::string>& words)
{
  pdx::options::OptionReader reader;
  reader.read_command_line(words);
  for (pdx::GivenOption& option : reader.take()) {
    PDX_CALL(PetscOptionsSetValue(nullptr, option.name.c_str(), option.value.empty() ? nullptr : option.value.c_str()));
    pdx::give_option(std::move(option));
  }
}

Outcome told(int status, const std::exception& e) { return {status, pdx::as_one_line(pdx::with_place(e.what()))}; }

Outcome run(const std::vector<std::string>& words)
{
  try {
    clear_options();
    read_options(words);
    pdx::app::run(PETSC_COMM_WORLD, MPI_Wtime());
    return {};
  } catch (const pdx::UserError& e) {
    return told(1, e);
  } catch (const pdx::SolverFailure& e) {
    return told(2, e);
  } catch (const std::exception& e) {
    return told(3, e);
  }
}

/// Ranks must end alike, whoever has the words for it.
Outcome agreed(Outcome mine)
{
  int bounds[2] = {mine.status, -mine.status};
  MPI_Allreduce(MPI_IN_PLACE, bounds, 2, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  if (bounds[0] == -bounds[1]) return mine;
  return {-1, "statuses " + std::to_string(-bounds[1]) + " to " + std::to_string(bounds[0]) + ": " + mine.message};
}

int run_all(const char* list, std::size_t first)
{
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  std::ifstream file(list);
  const auto cases = Json::parse(file).get<std::vector<std::vector<std::string>>>();
  for (std::size_t k = first; k < cases.size(); ++k) {
    if (rank == 0) std::fprintf(stderr, "\ncase %zu\n", k);
    const double begin = MPI_Wtime();
    const Outcome outcome = agreed(run(cases[k]));
    const Json line = {
        {"case", k}, {"status", outcome.status}, {"message", outcome.message}, {"seconds", MPI_Wtime() - begin}};
    if (rank == 0) std::printf("%s\n", line.dump(-1, ' ', true, Json::error_handler_t::replace).c_str());
    std::fflush(stdout);
  }
  if (rank == 0) std::fprintf(stderr, "\ncase %zu\n", cases.size()); // none: what was said in the last one ends here
  return 0;
}
} // namespace

int main(int argc, char** argv)
{
  if (argc != 3) return 1;
  if (PetscInitializeNoArguments()) return 3;
  pdx::install_quiet_error_handler();
  pdx::record::LastWords::prepare(PETSC_COMM_WORLD);
  const int code = run_all(argv[1], std::strtoul(argv[2], nullptr, 10));
  (void)PetscOptionsClear(nullptr);
  (void)PetscFinalize();
  return code;
}
