// Every text of the page.
export const TEXTS = {
  cycle_start: "Cycle start", feed_hold: "Feed hold", reset: "Reset", stop: "EMERGENCY STOP", release: "Release emergency stop",
  single_block: "Single block", dry_run: "Dry run", optional_stop: "Optional stop", block_delete: "Block delete",
  connected: "connected", lost: "connection lost", feed: "Feed", rapid: "Rapid", spindle: "Spindle",
  machine: "Machine", work: "Work", relative: "Relative", to_go: "To go", axis: "Axis", load: "Load", error: "Lag",
  programmed: "programmed", commanded: "commanded", actual: "actual", tool: "T", no_program: "No program selected",
  mdi: "MDI blocks", enter: "Enter", mode: "Mode", select: "Select", save: "Save", edit: "Edit", name: "Name", increment: "Step",
  programs: "Programs", path: "Path of the tool in X and Y", rapidly: "Rapid",
  modes: { auto: "Auto", mdi: "MDI", jog: "Jog", inc: "Inc", handle: "Wheel", ref: "Ref", edit: "Edit" },
  keys: "Alt+S start, Alt+H hold, Alt+R reset, Alt+X emergency stop; arrows jog X and Y, Page up and down Z, in Jog.",
};
