# shellcheck shell=bash
# Source me: lets Open MPI, 4 or 5 (which renamed half of these), run on this one machine, for this shell only. A value
# already set wins, and inside a batch job nothing is changed: there the scheduler knows cores and binding.
pdx_default() { eval "[ -n \"\${$1:-}\" ]" || export "$1=$2"; }
if [ -z "${SLURM_JOB_ID:-}${PBS_JOBID:-}${LSB_JOBID:-}" ]; then
  pdx_default OMPI_MCA_rmaps_base_oversubscribe 1                     # more ranks than cores is slow, not wrong
  pdx_default PRTE_MCA_rmaps_default_mapping_policy :oversubscribe    # the same in Open MPI 5
  pdx_default OMPI_MCA_mpi_yield_when_idle 1                          # a waiting rank lets others run: 60 times faster when crowded
  # No network is needed: looking for one takes 1.2 s of every start, and what is found may be odd.
  pdx_default OMPI_MCA_btl ^tcp,openib,usnic,ofi,uct
  pdx_default OMPI_MCA_pml ob1
  pdx_default OMPI_MCA_osc ^ucx
  pdx_default OMPI_MCA_btl_base_warn_component_unused 0
  pdx_default OMPI_MCA_orte_execute_quiet 1                           # a run's message is enough; Open MPI 5 always adds its own
  if [ "$(id -u)" -eq 0 ]; then                                       # root: usually a container, without ptrace or binding
    pdx_default OMPI_ALLOW_RUN_AS_ROOT 1
    pdx_default OMPI_ALLOW_RUN_AS_ROOT_CONFIRM 1
  fi
  if [ "$(id -u)" -eq 0 ] || [ -e /.dockerenv ] || [ -e /run/.containerenv ]; then
    pdx_default OMPI_MCA_btl_vader_single_copy_mechanism none
    pdx_default OMPI_MCA_smsc ^cma
    pdx_default OMPI_MCA_hwloc_base_binding_policy none
    pdx_default PRTE_MCA_hwloc_default_binding_policy none
  fi
fi
unset -f pdx_default
