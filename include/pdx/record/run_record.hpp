#pragma once
#include "pdx/options/scene_options.hpp"

#include <mpi.h>
#include <string>
#include <vector>

namespace pdx::record {
/// A paper or program that a run owes something to.
struct Source {
  const char* key;  ///< "giannakeas2020a"
  const char* what; ///< of it the run uses
  const char* name; ///< as one line: authors, year, doi
  const char* bibtex;
};
/// What a run with these options should cite.
std::vector<Source> sources_of(const options::SceneOptions& options);

/// The options as an options file that gives the same run again: what was given a line each, with its place behind, and
/// what was left at its default as comments. Names are those read so far. Not collective.
std::string options_as_used(MPI_Comm comm, const options::SceneOptions& options);

/// Writes options.opts and citations.bib into the output directory; a file of such a name that no run wrote stays.
/// Throws MachineFailure on every rank if the disk refuses. Collective.
void write_record(MPI_Comm comm, const options::SceneOptions& options);

/// What a log ends with.
std::string citation_line(const options::SceneOptions& options);
} // namespace pdx::record
