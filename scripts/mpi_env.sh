# shellcheck shell=bash
# Source me: lets Open MPI run on this machine, for this shell only. A value already set wins, and inside a batch
# job nothing is changed: there the scheduler knows cores and binding.
if [ -z "${SLURM_JOB_ID:-}${PBS_JOBID:-}${LSB_JOBID:-}" ]; then
  : "${OMPI_MCA_rmaps_base_oversubscribe:=1}"           # more ranks than cores is slow, not wrong
  : "${OMPI_MCA_mpi_yield_when_idle:=1}"                # a waiting rank lets others run: 60 times faster when crowded
  : "${OMPI_MCA_btl_base_warn_component_unused:=0}"     # no word about absent fast networks
  export OMPI_MCA_rmaps_base_oversubscribe OMPI_MCA_mpi_yield_when_idle OMPI_MCA_btl_base_warn_component_unused
  if [ "$(id -u)" -eq 0 ]; then                         # root: usually a container, without ptrace or binding
    : "${OMPI_ALLOW_RUN_AS_ROOT:=1}" "${OMPI_ALLOW_RUN_AS_ROOT_CONFIRM:=1}"
    export OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM
  fi
  if [ "$(id -u)" -eq 0 ] || [ -e /.dockerenv ] || [ -e /run/.containerenv ]; then
    : "${OMPI_MCA_btl_vader_single_copy_mechanism:=none}" "${OMPI_MCA_hwloc_base_binding_policy:=none}"
    export OMPI_MCA_btl_vader_single_copy_mechanism OMPI_MCA_hwloc_base_binding_policy
  fi
fi
