import { describe, expect, it } from "vitest";
import { ServiceClock } from "./service-clock";

/** The service's clock is 100 s ahead of the page's, whose times are in milliseconds. */
const stamp = (at: number): number => 100 + at / 1000;

describe("the age of data by their stamps", () => {
  it("is that since they were made, not since they came", () => {
    const clock = new ServiceClock();
    clock.roundTrip(0, 10, stamp(5));
    expect(clock.age(stamp(1000), 1000)).toBeCloseTo(0, 0);
    expect(clock.age(stamp(1000), 3600)).toBeCloseTo(2600, -1);
  });

  it("is right on a page that takes everything two seconds late", () => {
    const clock = new ServiceClock();
    clock.arrived(stamp(0), 2000);
    expect(clock.age(stamp(0), 2000)).toBe(0); // nothing tells otherwise yet
    clock.roundTrip(2000, 4000, stamp(2001));
    expect(clock.age(stamp(3000), 5000)).toBeCloseTo(2000, -1);
  });

  it("takes the best of many round trips, some of which were held up on either way", () => {
    const clock = new ServiceClock();
    clock.roundTrip(0, 900, stamp(890));
    clock.roundTrip(1000, 1900, stamp(1005));
    clock.roundTrip(2000, 2010, stamp(2004));
    clock.roundTrip(3000, 3900, stamp(3890));
    expect(clock.age(stamp(4000), 4700)).toBeCloseTo(700, -1);
  });

  it("starts over when a clock has stood still, in either direction", () => {
    const asleep = new ServiceClock();
    asleep.roundTrip(0, 10, stamp(5));
    asleep.arrived(stamp(3_600_000), 20); // the page's clock stood for an hour
    expect(asleep.age(stamp(3_600_000), 20)).toBe(0);
    const other = new ServiceClock();
    other.roundTrip(0, 10, stamp(5));
    other.roundTrip(1000, 1010, 7.1); // another service, younger
    expect(other.age(7.1, 1010)).toBeLessThan(20);
  });

  it("knows nothing of a service that has said nothing", () => {
    expect(new ServiceClock().age(1, 5000)).toBe(0);
  });
});
