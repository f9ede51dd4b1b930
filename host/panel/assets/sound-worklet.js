// Plays samples in the order in which they come, in the thread of the browser's sound.

// 50 ms lie between the first sample that comes and its sound; where 150 ms wait, the oldest are left out.
const LEAD = 2400;
const MOST = 7200;
const ROOM = 16384;

registerProcessor(
  "torque",
  class extends AudioWorkletProcessor {
    constructor() {
      super();
      this.ring = new Float32Array(ROOM);
      this.written = 0;
      this.played = 0;
      this.plays = false;
      this.port.onmessage = ({ data }) => this.take(data);
    }

    take(samples) {
      for (const sample of samples) this.ring[this.written++ % ROOM] = sample;
      if (this.written - this.played > MOST) this.played = this.written - LEAD;
    }

    process(inputs, [[out]]) {
      this.plays ||= this.written - this.played >= LEAD;
      for (let i = 0; i < out.length; i++) {
        this.plays &&= this.played < this.written;
        out[i] = this.plays ? this.ring[this.played++ % ROOM] : 0;
      }
      return true;
    }
  },
);
