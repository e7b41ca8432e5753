import { describe, expect, it } from "vitest";
import type { LinkStatus, StreamStatus } from "../../api/types";
import { age, holderOf, milliseconds, modeOf, offsetWords, streamWord } from "./labels";

const ROBOT: NonNullable<LinkStatus["robot"]> = {
  age: 0.02,
  mode: "following",
  why: "",
  contract: "2",
  session: "a.2",
  tared: true,
  commands: 10,
  refused: 0,
  last_refusal: "",
};
const LINK: LinkStatus = {
  plant: "zenoh",
  connected: true,
  endpoints: ["tcp/127.0.0.1:7447"],
  contract: "2",
  deadline: 0.1,
  contact_threshold: 0.12,
  session: "a.2",
  holder: "a.2",
  held: true,
  robot_identity: "testbed.1f",
  other_robots: [],
  robot: ROBOT,
  streams: [],
  refused_messages: [],
  clock_offset: 0,
  round_trip: null,
  command_age: null,
  latency: [],
  stop: null,
  problem: null,
};
const STREAM: StreamStatus = {
  key: "becalm/joint_states",
  name: "joint states",
  message: "sensor_msgs/msg/JointState",
  nominal_rate: 200,
  rate: 199.5,
  age: 0.003,
  jitter: 0.0004,
  loss: 0,
  received: 1000,
  lost: 0,
  needed: true,
  late: false,
  refused: 0,
  last_refusal: "",
  refusal_age: null,
};

describe("the robot's mode", () => {
  it("is told apart by words and signs, not by colour alone", () => {
    const modes = ["following", "waiting", "holding", "stopped", null] as const;
    const told = modes.map((mode) => modeOf({ ...LINK, robot: { ...ROBOT, mode } }));
    expect(new Set(told.map(({ word }) => word)).size).toBe(modes.length);
    expect(new Set(told.map(({ icon }) => icon)).size).toBe(modes.length);
  });

  it("says whom it follows", () => {
    expect(modeOf(LINK).word).toBe("Following");
    expect(modeOf({ ...LINK, held: false, holder: "b.7" }).word).toBe("Following another");
  });

  it("is not the present of a robot that has fallen silent", () => {
    const silent = modeOf({ ...LINK, robot: { ...ROBOT, age: 2.34 } });
    expect(silent.word).toBe("Silent");
    expect(silent.detail).toContain("2.3 s ago: following");
    expect(modeOf({ ...LINK, robot: null }).word).toBe("No robot");
  });

  it("gives the robot's own reason", () => {
    const holding = modeOf({ ...LINK, held: false, robot: { ...ROBOT, mode: "holding", why: "no heartbeat for 104 ms" } });
    expect(holding.detail).toBe("No heartbeat for 104 ms. Reset to take it over again.");
  });
});

describe("who holds the robot", () => {
  it("is this console, another one, or nobody", () => {
    expect(holderOf(LINK)).toBe("this console");
    expect(holderOf({ ...LINK, held: false, holder: "b.7" })).toBe("another console");
    expect(holderOf({ ...LINK, held: false, holder: "" })).toBe("nobody");
    expect(holderOf({ ...LINK, held: false })).toBe("nobody; last this console");
  });
});

describe("a stream", () => {
  it("is good, slow, late, or has not come", () => {
    expect(streamWord(STREAM).word).toBe("good");
    expect(streamWord({ ...STREAM, rate: 160 }).word).toBe("slow");
    expect(streamWord({ ...STREAM, late: true }).tone).toBe("error");
    expect(streamWord({ ...STREAM, late: true, needed: false }).tone).toBe("warning");
    expect(streamWord({ ...STREAM, age: null, late: true }).word).toBe("none yet");
  });

  it("that comes and is not believed is refused, with the reason", () => {
    const refused = { ...STREAM, refused: 300, last_refusal: "not finite: force.x = nan", refusal_age: 0.004 };
    expect(streamWord({ ...refused, late: true })).toMatchObject({ word: "refused", tone: "error", detail: "Not finite: force.x = nan." });
    expect(streamWord({ ...refused, late: true, age: null }).word).toBe("refused");
    expect(streamWord({ ...refused, late: true, needed: false }).tone).toBe("warning");
    expect(streamWord({ ...refused, late: true, refusal_age: 12 }).word).toBe("late");
    expect(streamWord(refused).word).toBe("good");
  });
});

describe("times", () => {
  it("are read in milliseconds while they are short", () => {
    expect(milliseconds(0.00123)).toBe("1.2");
    expect(milliseconds(null)).toBe("—");
    expect(age(0.0049)).toBe("5 ms");
    expect(age(12.4)).toBe("12 s");
  });

  it("say whose clock is ahead", () => {
    expect(offsetWords(3.50001)).toEqual({ value: "3.5000 s", sense: "the robot's clock is ahead" });
    expect(offsetWords(-0.00125)).toEqual({ value: "1.25 ms", sense: "the robot's clock is behind" });
    expect(offsetWords(null).value).toBe("—");
  });
});
