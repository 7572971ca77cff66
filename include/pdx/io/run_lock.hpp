#pragma once
#include "pdx/io/agree.hpp"
#include "pdx/io/disk_file.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>

namespace pdx::io {
/// A directory belongs to one run at a time: `run.lock` in it says which, with host, process and time. It is there
/// while the run lives; one that a killed run left is taken over. On this machine the kernel's lock on the file tells
/// which is which, and process and start time where there is none; a run of another machine shows by touching the file.
class RunLock {
public:
  /// Throws UserError on every rank while another run lives there. Collective.
  RunLock(MPI_Comm comm, const std::filesystem::path& directory);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  /// Takes the lock of this run away, on any rank and in a signal handler too: the process is about to end.
  static void drop() noexcept;

private:
  Fault take();
  bool lives(const std::string& owner, bool locked);
  void beat();

  std::filesystem::path path_;
  DiskFile file_; // on rank 0
  std::mutex mutex_;
  std::condition_variable end_;
  bool over_ = false;
  std::thread heart_; // on rank 0: touches the file
};
} // namespace pdx::io
