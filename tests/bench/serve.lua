-- What wrk asks of eskeld, and the lines that table.py reads:
--
--    FIGURE=name wrk -t 1 ... -s serve.lua URL -- recognize IDS [PARAMETERS] | enroll FOLDER COUNT | health
--
-- One thread only: a second one would send the same requests again.

local next_request = 0
local enrolling = false

local function lines_of(path)
   local all = {}
   for line in io.lines(path) do
      all[#all + 1] = line
   end
   return all
end

local function bytes_of(path)
   local file = assert(io.open(path, "rb"))
   local bytes = file:read("*a")
   file:close()
   return bytes
end

local requests = {}

function init(arguments)
   if arguments[1] == "recognize" then
      for i, id in ipairs(lines_of(arguments[2])) do
         requests[i] = wrk.format("GET", "/recognize?shape=" .. id .. arguments[3])
      end
   elseif arguments[1] == "enroll" then
      enrolling = true
      for i = 1, tonumber(arguments[3]) do
         local body = bytes_of(arguments[2] .. "/post-" .. (i - 1) .. ".nii.gz")
         requests[i] = wrk.format("POST", "/shapes", {["Content-Type"] = "application/octet-stream"}, body)
      end
   else
      requests[1] = wrk.format("GET", "/healthz")
   end
end

-- 7919 is prime to every count of requests here, so that all come up, in no order.
-- A shape that is posted again is not stored again, so posts must not run out.
function request()
   if enrolling and next_request == #requests then
      io.stderr:write("all posts were sent: ask for fewer seconds\n")
      os.exit(1)
   end
   next_request = next_request + 1
   return requests[next_request * 7919 % #requests + 1]
end

function done(summary, latency)
   local seconds = summary.duration / 1e6
   local errors = summary.errors
   local failed = errors.status + errors.connect + errors.read + errors.write + errors.timeout
   if failed > 0 then
      io.stderr:write(string.format("%d requests failed\n", failed))
      os.exit(1)
   end
   local figure = os.getenv("FIGURE")
   io.write(string.format("%s\teskeld\t%.6g\tper s\n", figure, summary.requests / seconds))
   io.write(string.format("%s\teskeld\t%.6g\tms p99\n", figure, latency:percentile(99) / 1e3))
end
