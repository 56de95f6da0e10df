// Every text of the page.
export const TEXTS = {
  // keys and switches
  cycle_start: "Cycle start", feed_hold: "Feed hold", reset: "Reset", stop: "EMERGENCY STOP", release: "Release emergency stop",
  single_block: "Single block", dry_run: "Dry run", optional_stop: "Optional stop", block_delete: "Block delete", machine_lock: "Machine lock",
  modes: { auto: "Auto", mdi: "MDI", jog: "Jog", inc: "Inc", handle: "Wheel", ref: "Ref", edit: "Edit" },
  marks: "Marks that block delete skips", channel_choice: "Channel",
  mode_group: "Modes", key_group: "Keys", switch_group: "Switches",
  feed: "Feed", rapid: "Rapid", spindle: "Spindle",
  // state
  connected: "connected", lost: "connection lost", machine_choice: "Machine", rate: "Rate of the clock", frozen: "frozen", one_cycle: "1 cycle", next_event: "Next event", far: "Read-out", help: "Keys ?", close: "Close",
  theme: "Colours", themes: { system: "System", light: "Light", dark: "Dark" },
  operator: "Operator", commands: "commands", take_over: "take over", give_back: "You command: let others", hold: "Command alone", your_name: "Your name, as others see it",
  machine: "Machine", work: "Work", relative: "Relative", to_go: "To go", axis: "Axis", load: "Load", error: "Lag", unreferenced: "Not referenced",
  programmed: "programmed", commanded: "commanded", actual: "actual",
  speed: "Path speed, mm/min", lag: "Following error, mm or degree", path: "Path of the tool", no_picture: "This browser shows no three-dimensional pictures (WebGL).", views: { "3-D": "3-D", Top: "Top", Front: "Front", Side: "Side" },
  // by hand
  mdi: "MDI blocks", enter: "Enter", history: "History", increment: "Step", rapidly: "Rapid", zero: "Relative = 0",
  wheel: "Handwheel", wheel_axis: "Axis of the handwheel", wheel_hint: "Turn it with the mouse wheel, by dragging, or with the arrow keys.",
  // the program
  no_program: "No program selected", line: "line", cycle_time: "time", left: "left", parts_made: "parts",
  from_line: "Run from line", breakpoint: "Breakpoint", steps: { over: "Step", into: "Into", out: "Out" }, searched: "Press cycle start: it begins at this line",
  // pages
  all_pages: "Pages",
  pages: { run: "Run", programs: "Programs", tools: "Tools", offsets: "Offsets", parameters: "Parameters", variables: "Variables", alarms: "Alarms", signals: "I/O", screen: "Screen", tasks: "Tasks", scenario: "Scenario", snapshots: "Snapshots", connections: "Connections" },
  number: "Number", value: "Value", meaning: "Meaning", text: "Text", name: "Name", add: "Add", remove: "Delete", none: "There are none.", no_number: "This is no number.", filter: "Number or word", more: (count) => `${count} more: name those that you look for.`,
  programs: "Programs", select: "Select", edit: "Edit", edit_text: "Text of the program", save: "Save", download: "Download", bring: "Open file", compare: "Compare",
  drop: "or drop files here", name_it: "Give it a name.", saved: (name) => `${name} is saved.`, left_as_written: (name) => `${name} came late: what has been written here meanwhile stays.`, sure: (name) => `Delete ${name}?`, brought: (count) => `${count} programs are saved.`, left_out: (names) => `Left out: ${names}.`,
  no_errors: "No errors.", elsewhere: "elsewhere", too_long: "This text is too long to be checked while it is written.",
  compared: (name, count) => (count ? `${name} in the memory (−) and the text above (+): ${count} lines differ` : `${name} in the memory is the same as the text above`), too_different: "These texts have too little in common.",
  tool_fields: { length_mm: "Length", radius_mm: "Radius", wear_length_mm: "Wear of length", wear_radius_mm: "Wear of radius", x_mm: "X", z_mm: "Z", wear_x_mm: "Wear X", wear_z_mm: "Wear Z", tip: "Tip" },
  touch: "Touch Z 0", touched: "Its length is set.", touch_hint: "Touch Z 0: the tool touches the surface that is Z 0 of the work offset in force; its length follows from that.",
  offset: "Offset", teach: "Teach", taught: "Program zero is here", teach_hint: "Teach and ◎ put program zero where the axes are now, all of them or one.",
  watch: { variables: "Variables to watch, with commas; none: all", signals: "Addresses to watch, with commas; none: all" },
  now: "now", to_do: "What to do", time: "Time", message: "Message to the operator", no_alarms: "There are no alarms.", forget_all: "Forget past alarms",
  cleared: { reset: "Mend its cause, then press Reset.", cause: "It goes when its cause has gone.", power: "Switch the control off and on." },
  cycle: "Cycle", keep: "Keep", restore: "Restore", forget: "Forget", snapshot_hint: "A snapshot is the whole state of the machine: keep it, try something, go back.",
  door: "Door", address: "Address", clients: "Clients",
  screen_hint: "Click the screen to type: F1 to F8 are its softkeys, Esc is level return.", keys_of_screen: { ENTER: "Enter", DELETE: "Delete", CURSOR_UP: "↑", CURSOR_DOWN: "↓", CURSOR_RIGHT: "→", CURSOR_LEFT: "←", LEVEL_RETURN: "Level return" },
  task: "Task", state: "State", error_of: "Error", tasks_do: { start: "Start", stop: "Stop", continue: "Continue" }, source: "Program of a task, in rw_SymPas",
  scenario_text: "Text of the scenario", scenario_start: "Begin again", scenario_stop: "End", scenario_put: "Follow this text", happened: "What has happened",
  scenario_hint: "A TOML file with steps. Follow this text: it is checked, and begins now in place of the one before.", scenario_example: 'title = "A short stop"\n\n[[step]]\nname = "stop"\ndo = "feed_hold"\nat_s = 5.0\nfor_s = 2.0\n',
  no_scenario: "No scenario is followed.", nothing_yet: "Nothing yet.", runs: "followed for", ended: "ended", step_waits: "waits", step_on: "on", step_done: "over", step_heads: ["Step", "Does", "With", "Begins", "Ends, repeats", "State"],
  // keys of the keyboard
  shortcuts: "Keys of the keyboard",
  does: { cycle_start: "Cycle start", feed_hold: "Feed hold", reset: "Reset", stop: "Press the emergency stop", step_over: "Step", single_block: "Single block on or off", mdi: "Write MDI blocks", lines: "Choose a line of the program",
    "tab-run": "Page Run", "tab-programs": "Page Programs", "tab-tools": "Page Tools", "tab-offsets": "Page Offsets", "tab-alarms": "Page Alarms", far: "Read-out on or off", help: "This list" },
  by_hand: {
    arrows: ["← → ↑ ↓", "Jog X and Y (on a lathe Z and X) while held, in Jog; one step in Inc and Wheel"], pages: ["Page up, Page down", "The same for Z"], shift: ["Shift with these", "At rapid, in Jog and Inc"],
    space: ["Space, Enter", "Press the key in focus; a jog key as long as they are held; on a line of the program Space sets a breakpoint"], wheel: ["Arrows, Page up, Page down", "On the handwheel: 1 and 10 pulses"],
    mdi_history: ["↑ ↓", "In MDI: blocks that were put in before"], mdi_lines: ["Enter, Shift+Enter", "In MDI: execute the blocks; a further line"],
  },
};
