#pragma once
#include "pdx/io/hdf5_file.hpp"
#include "pdx/io/sealed_reader.hpp"

#include <functional>
#include <map>

namespace pdx::record {
/// Numbers of a checkpoint by name.
using NamedNumbers = std::map<std::string, double>;

constexpr const char* kGivenOptions = "/options"; ///< what makes a scene this one as the options say it
constexpr const char* kStandingScene = "/scene";  ///< likewise as it stands

/// Numbers as a table of one column, and their names, a line each. Collective. @param numbers those of rank 0 count
void write_numbers(io::Hdf5File& file, const NamedNumbers& numbers);
/// Throws UserError for names and numbers that do not belong together. Collective.
NamedNumbers read_numbers(const io::SealedReader& file);

/// Throws UserError where a text of "name = value" lines in the file is not this run's, naming the first of them that
/// differs. Collective. @param path of the file, as it was given
void refuse_another(const io::SealedReader& file, const std::string& path, const char* text, const std::string& mine);

/// Of the run with this output directory.
std::filesystem::path checkpoint_in(const std::string& directory);
/// Does a checkpoint lie there? As rank 0 sees it. Collective.
bool is_of(MPI_Comm comm, const std::string& checkpoint, const std::string& directory);
/// Writes a sealed file that takes the place of `path` once it is whole. Collective.
void write_checkpoint(MPI_Comm comm, const std::filesystem::path& path, const std::function<void(io::Hdf5File&)>& fill);
} // namespace pdx::record
