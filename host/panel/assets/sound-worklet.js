// Plays samples in the order in which they come, in the thread of the browser's sound.

const ROOM = 16384;

registerProcessor(
  "torque",
  class extends AudioWorkletProcessor {
    // `lead`: samples between the first that comes and its sound. Where more than `most` wait, the oldest go.
    constructor({ processorOptions: { lead, most } }) {
      super();
      this.lead = lead;
      this.most = most;
      this.ring = new Float32Array(ROOM);
      this.written = 0;
      this.played = 0;
      this.plays = false;
      this.port.onmessage = ({ data }) => this.take(data);
    }

    take(samples) {
      for (const sample of samples) this.ring[this.written++ % ROOM] = sample;
      if (this.written - this.played > this.most) this.played = this.written - this.lead;
    }

    process(inputs, [[out]]) {
      this.plays ||= this.written - this.played >= this.lead;
      for (let i = 0; i < out.length; i++) {
        this.plays &&= this.played < this.written;
        out[i] = this.plays ? this.ring[this.played++ % ROOM] : 0;
      }
      return true;
    }
  },
);
